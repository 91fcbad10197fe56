/* SPDX-License-Identifier: BSD-3-Clause */
/** The header of OFF: its word, and the counts of a text. */
#include "meshio/common/format.h"
#include "meshio/formats/off.h"

#include <inttypes.h>

static bool starts_with(const vxm_tokenizer *scan, const char *word) {
  const unsigned char *p = scan->at;
  for (; *word; word++, p++)
    if (p == scan->end || (*p & 0xdf) != *word)
      return false;
  return true;
}

/** Reads the first word; false if it is not one of OFF's. The cursor ends behind it, before glued counts. */
static bool read_word(vxm_tokenizer *scan, vxm_off_header *header) {
  *header = (vxm_off_header){.dimension = 3};
  for (int prefix = 0; prefix < 6; prefix++) {
    if (starts_with(scan, "OFF")) {
      scan->at += 3;
      return scan->at == scan->end || *scan->at <= ' ' || *scan->at == '#' || vxm_is_digit(*scan->at);
    }
    if (starts_with(scan, "ST")) {
      header->textures = true;
      scan->at++;
    } else if (scan->at < scan->end && *scan->at == 'C')
      header->colours = true;
    else if (scan->at < scan->end && *scan->at == 'N')
      header->normals = true;
    else if (scan->at < scan->end && *scan->at == 'n')
      header->n_dimensional = true;
    else if (scan->at < scan->end && *scan->at == '4')
      header->four = true;
    else
      return false;
    scan->at++;
  }
  return false;
}

vxm_likeness vxm_off_sniff(const unsigned char *data, size_t size) {
  vxm_tokenizer scan = {.begin = data, .at = data, .end = data + size};
  vxm_off_header header;
  if (!vxm_off_skip_to_data(&scan))
    return VXM_LIKENESS_NONE;
  vxm_tokenizer counts = scan;
  if (read_word(&scan, &header))
    return VXM_LIKENESS_CERTAIN;
  /* Without the word: a line of two or three whole numbers. */
  size_t numbers = 0;
  uint64_t count;
  while (vxm_more_on_line(&counts) && vxm_tokenizer_uint(&counts, &count))
    numbers++;
  return vxm_at_line_end(&counts) && (numbers == 2 || numbers == 3) ? VXM_LIKENESS_POSSIBLE
                                                                    : VXM_LIKENESS_NONE;
}

static vxm_status read_count(vxm_tokenizer *scan, const char *what, uint64_t *count, vxm_error *error) {
  if (!vxm_off_skip_to_data(scan))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->end),
                       "the file ends before the number of %s", what);
  if (vxm_tokenizer_uint(scan, count))
    return VXM_OK;
  char quote[VXM_QUOTE];
  return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                     "the number of %s is not a whole number: \"%s\"", what,
                     vxm_quote(quote, scan->at, vxm_token_length(scan)));
}

/** Words behind the counts on their line. They are passed over where each vertex and each face has a line of
 * its own further down; else they may be the first vertices of a file that keeps to no lines. */
static vxm_status skip_surplus(vxm_tokenizer *scan, const vxm_off_header *header, uint64_t items,
                               vxm_error *error) {
  size_t words = vxm_tokens_on_line(scan, '#');
  vxm_tokenizer behind = *scan;
  if (words == 0)
    return VXM_OK;
  vxm_skip_line(&behind);
  if (vxm_lines_with_data(&behind, '#', items) == items) {
    vxm_warn(&scan->soup->warnings,
             "line %" PRId64 ": more than three counts; the rest of the line is passed over",
             vxm_tokenizer_line(scan, scan->at));
    *scan = behind;
  } else if (words < header->dimension)
    return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                       "more than three counts, and what follows them is no vertex");
  return VXM_OK;
}

/** Skips the number of edges, which says nothing and is often left out, or no number at all. */
static vxm_status skip_edge_count(vxm_tokenizer *scan, const vxm_off_header *header, bool one_per_line,
                                  uint64_t items, vxm_error *error) {
  uint64_t edges;
  vxm_tokenizer ahead = *scan;
  vxm_skip_blanks(&ahead);
  if (!vxm_at_line_end(&ahead) && *ahead.at != '#') {
    vxm_skip_token(&ahead);
    *scan = ahead;
    return skip_surplus(scan, header, items, error);
  }
  /* Where the other counts had a line each, this one may have too. */
  if (one_per_line && vxm_off_skip_to_data(&ahead) && vxm_tokens_on_line(&ahead, '#') == 1 &&
      vxm_tokenizer_uint(&ahead, &edges))
    *scan = ahead;
  return VXM_OK;
}

vxm_status vxm_off_read_counts(vxm_tokenizer *scan, const vxm_off_header *header, uint64_t *vertices,
                               uint64_t *faces, vxm_error *error) {
  vxm_status status = read_count(scan, "vertices", vertices, error);
  if (status != VXM_OK)
    return status;
  vxm_skip_blanks(scan);
  bool one_per_line = vxm_at_line_end(scan);
  status = read_count(scan, "faces", faces, error);
  if (status != VXM_OK)
    return status;
  uint64_t items = *vertices + *faces;
  return skip_edge_count(scan, header, one_per_line, items < *faces ? UINT64_MAX : items, error);
}

vxm_status vxm_off_read_header(vxm_tokenizer *scan, vxm_off_header *header, vxm_error *error) {
  bool any = vxm_off_skip_to_data(scan);
  const unsigned char *first = scan->at;
  if (!any || !read_word(scan, header)) {
    if (!any || !vxm_is_digit(*first)) {
      char quote[VXM_QUOTE];
      size_t length = (size_t)(vxm_find_newline(first, scan->end) - first);
      return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, first), "no OFF header: \"%s\"",
                         vxm_quote(quote, first, length));
    }
    *header = (vxm_off_header){.missing = true, .dimension = 3};
    scan->at = first;
  }
  header->at = first;
  vxm_skip_blanks(scan);
  if (starts_with(scan, "BINARY")) {
    header->binary = true;
    vxm_skip_line(scan);
    return VXM_OK;
  }
  uint64_t dimension = 3;
  if (header->n_dimensional) {
    vxm_status status = read_count(scan, "dimensions", &dimension, error);
    if (status != VXM_OK)
      return status;
    if (dimension == 0 || dimension > (uint64_t)(scan->end - scan->begin))
      return vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_tokenizer_place(scan, scan->at),
                         "%" PRIu64 " dimensions cannot be read", dimension);
  }
  header->dimension = (size_t)dimension + header->four;
  return VXM_OK;
}
