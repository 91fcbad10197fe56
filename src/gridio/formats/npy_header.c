/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/npy_header.h"
#include "gridio/common/format.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Format 1.0: 6 bytes magic, 2 of version, 2 of length, then the text. 2.0 and 3.0 have 4 of length. */
static const unsigned char magic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};

bool vxm_npy_sniff(const vxm_input *input) {
  return input->size >= sizeof magic && memcmp(input->data, magic, sizeof magic) == 0;
}

/* ---- A small strict parser of the one dictionary that numpy writes ---- */

typedef struct scanner {
  const vxm_input *input;
  vxm_error *error;
  size_t at, end;
} scanner;

static vxm_status fail(const scanner *s, const char *what) {
  return vxm_fail_byte(s->error, s->input, s->at, "npy header: %s", what);
}

static void skip_space(scanner *s) {
  while (s->at < s->end && memchr(" \t\r\n", s->input->data[s->at], 4))
    s->at++;
}

static bool accept(scanner *s, char c) {
  skip_space(s);
  if (s->at == s->end || s->input->data[s->at] != (unsigned char)c)
    return false;
  s->at++;
  return true;
}

static bool accept_word(scanner *s, const char *word) {
  skip_space(s);
  size_t length = strlen(word);
  if (s->end - s->at < length || memcmp(s->input->data + s->at, word, length) != 0)
    return false;
  s->at += length;
  return true;
}

/** A quoted text without escapes, shorter than 16 bytes. */
static vxm_status read_text(scanner *s, char text[16]) {
  skip_space(s);
  unsigned char quote = s->at < s->end ? s->input->data[s->at] : 0;
  if (quote != '\'' && quote != '"')
    return fail(s, "a quoted text is expected");
  size_t begin = s->at + 1, length = 0;
  while (begin + length < s->end && s->input->data[begin + length] != quote)
    length++;
  if (begin + length == s->end || length > 15)
    return fail(s, "a quoted text does not end");
  memcpy(text, s->input->data + begin, length);
  text[length] = '\0';
  s->at = begin + length + 1;
  return VXM_OK;
}

static vxm_status read_descr(scanner *s, vxm_npy_header *h) {
  size_t begin = s->at;
  char text[16];
  skip_space(s);
  if (s->at < s->end && s->input->data[s->at] == '[')
    return fail(s, "an array of records is not a grid");
  vxm_status status = read_text(s, text);
  if (status != VXM_OK)
    return status;
  bool order_known = memchr("<>|=", text[0], 4) && text[0];
  char kind = order_known ? text[1] : 0, size = kind ? text[2] : 0;
  if (!kind || !memchr("biuf", kind, 4) || !size || !memchr("1248", size, 4) || text[3] != '\0' ||
      (kind == 'b' && size != '1') || (kind == 'f' && size == '1')) {
    s->at = begin;
    return fail(s, "elements must be booleans, integers or floating-point numbers of 1 to 8 bytes");
  }
  h->kind = kind;
  h->size = (size_t)(size - '0');
  /* '=' is the byte order of the machine that wrote; numpy itself never writes it. */
  h->big_endian = text[0] == '>';
  return VXM_OK;
}

static vxm_status read_order(scanner *s, vxm_npy_header *h) {
  h->fortran = accept_word(s, "True");
  if (!h->fortran && !accept_word(s, "False"))
    return fail(s, "fortran_order must be True or False");
  return VXM_OK;
}

static vxm_status read_extent(scanner *s, int64_t *extent) {
  skip_space(s);
  size_t begin = s->at;
  uint64_t value = 0;
  for (; s->at < s->end && s->input->data[s->at] >= '0' && s->input->data[s->at] <= '9'; s->at++) {
    if (value > INT64_MAX / 10 - 1)
      return fail(s, "the shape is too large");
    value = value * 10 + (uint64_t)(s->input->data[s->at] - '0');
  }
  if (s->at == begin)
    return fail(s, "the shape must be three whole numbers in brackets");
  accept(s, 'L'); /* Python 2 wrote long integers so */
  *extent = (int64_t)value;
  return VXM_OK;
}

static vxm_status read_shape(scanner *s, vxm_npy_header *h) {
  skip_space(s);
  h->shape_offset = s->at;
  if (!accept(s, '('))
    return fail(s, "the shape must be three whole numbers in brackets");
  for (int a = 0; a < 3; a++) {
    if (a > 0 && !accept(s, ','))
      return fail(s, "a grid has three dimensions");
    vxm_status status = read_extent(s, &h->shape[a]);
    if (status != VXM_OK)
      return status;
  }
  h->channels = 1;
  bool is_more = accept(s, ',');
  if (accept(s, ')'))
    return VXM_OK;
  int64_t channels = 0;
  vxm_status status = is_more ? read_extent(s, &channels) : VXM_OK;
  if (status != VXM_OK)
    return status;
  accept(s, ',');
  if (channels != 4 || !accept(s, ')'))
    return fail(s, "a grid has three dimensions, and colours a fourth of 4 bytes");
  h->channels = 4;
  return VXM_OK;
}

/** Colours are bytes, each four of them together. */
static vxm_status check_channels(const scanner *s, const vxm_npy_header *h) {
  if (h->channels == 4 && (h->kind != 'u' || h->size != 1 || h->fortran))
    return fail(s, "a grid has three dimensions, and colours a fourth of 4 bytes");
  return VXM_OK;
}

static vxm_status read_dictionary(scanner *s, vxm_npy_header *h) {
  static const struct {
    const char *key;
    vxm_status (*read)(scanner *s, vxm_npy_header *h);
  } entries[3] = {{"descr", read_descr}, {"fortran_order", read_order}, {"shape", read_shape}};
  unsigned seen = 0;
  if (!accept(s, '{'))
    return fail(s, "a dictionary is expected");
  while (!accept(s, '}')) {
    size_t begin = s->at;
    char key[16];
    vxm_status status = read_text(s, key);
    if (status != VXM_OK)
      return status;
    unsigned e = 0;
    while (e < 3 && strcmp(entries[e].key, key) != 0)
      e++;
    if (e == 3 || (seen >> e & 1)) {
      s->at = begin;
      return fail(s, e == 3 ? "an unknown key" : "a key is repeated");
    }
    seen |= 1u << e;
    if (!accept(s, ':'))
      return fail(s, "':' is expected");
    status = entries[e].read(s, h);
    if (status != VXM_OK)
      return status;
    if (accept(s, ','))
      continue;
    if (accept(s, '}'))
      break;
    return fail(s, "',' or '}' is expected");
  }
  skip_space(s);
  if (s->at != s->end)
    return fail(s, "text behind the dictionary");
  return seen == 7 ? VXM_OK : fail(s, "descr, fortran_order and shape are needed");
}

vxm_status vxm_npy_header_read(vxm_npy_header *out, const vxm_input *input, vxm_error *error) {
  *out = (vxm_npy_header){0};
  if (!vxm_npy_sniff(input))
    return vxm_fail_byte(error, input, 0, "not a npy file: it does not begin with \"\\x93NUMPY\"");
  const unsigned char *data = input->data;
  unsigned version = input->size > 6 ? data[6] : 0;
  size_t begin = version == 1 ? 10 : 12;
  if (input->size > 6 && (version < 1 || version > 3))
    return vxm_fail_byte(error, input, 6, "npy version %u is unknown; 1 to 3 can be read", version);
  if (input->size < begin)
    return vxm_fail_byte(error, input, input->size, "the file ends within its header");
  size_t length = data[8] | (size_t)data[9] << 8;
  if (version > 1)
    length |= (size_t)data[10] << 16 | (size_t)data[11] << 24;
  if (length > input->size - begin)
    return vxm_fail_byte(error, input, input->size, "the file ends within its header");
  out->data = begin + length;
  scanner s = {input, error, begin, out->data};
  vxm_status status = read_dictionary(&s, out);
  return status == VXM_OK ? check_channels(&s, out) : status;
}

/** The magic number, the version and the dictionary, of which `text` holds `length` bytes and has room for 64
 * more. */
static void write_header(vxm_output *output, char *text, int length) {
  enum { BEGIN = 10, ALIGN = 64 };
  /* Spaces and a line end fill the header up to the alignment. */
  size_t used = (size_t)length, total = (BEGIN + used + 1 + ALIGN - 1) / ALIGN * ALIGN - BEGIN;
  memset(text + used, ' ', total - used - 1);
  text[total - 1] = '\n';
  const unsigned char head[4] = {1, 0, (unsigned char)(total & 0xff), (unsigned char)(total >> 8)};
  vxm_output_write(output, magic, sizeof magic);
  vxm_output_write(output, head, sizeof head);
  vxm_output_write(output, text, total);
}

void vxm_npy_header_write(vxm_output *output, const char *type, bool fortran, const int64_t shape[3]) {
  char text[256];
  int length =
      snprintf(text, sizeof text,
               "{'descr': '%s', 'fortran_order': %s, 'shape': (%" PRId64 ", %" PRId64 ", %" PRId64 "), }",
               type, fortran ? "True" : "False", shape[0], shape[1], shape[2]);
  write_header(output, text, length);
}

void vxm_npy_header_write_bytes(vxm_output *output, const int64_t shape[3], int last) {
  char text[256];
  int length = snprintf(text, sizeof text,
                        "{'descr': '|u1', 'fortran_order': False, 'shape': (%" PRId64 ", %" PRId64
                        ", %" PRId64 ", %d), }",
                        shape[0], shape[1], shape[2], last);
  write_header(output, text, length);
}

void vxm_npy_header_write_table(vxm_output *output, const char *type, int64_t rows, int64_t columns) {
  char text[256];
  int length = snprintf(text, sizeof text,
                        "{'descr': '%s', 'fortran_order': False, 'shape': (%" PRId64 ", %" PRId64 "), }",
                        type, rows, columns);
  write_header(output, text, length);
}
