/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/tokenizer.h"

#include <inttypes.h>
#include <stdio.h>

vxm_tokenizer vxm_tokenizer_of(vxm_soup *soup, const unsigned char *data, size_t size, const char *name) {
  return (vxm_tokenizer){.begin = data,
                         .at = data,
                         .end = data + size,
                         .report_at = size < VXM_REPORT_BYTES ? data + size : data + VXM_REPORT_BYTES,
                         .name = name,
                         .soup = soup};
}

vxm_status vxm_tokenizer_report(vxm_tokenizer *scan, vxm_error *error) {
  size_t size = (size_t)(scan->end - scan->begin), done = (size_t)(scan->at - scan->begin);
  scan->report_at = size - done < VXM_REPORT_BYTES ? scan->end : scan->at + VXM_REPORT_BYTES;
  return vxm_progress(scan->soup->context, "reading", size ? (double)done / (double)size : 1.0, error);
}

int64_t vxm_tokenizer_line(const vxm_tokenizer *scan, const unsigned char *position) {
  int64_t line = 1;
  const unsigned char *p = scan->begin;
  for (;;) {
    p = vxm_find_newline(p, position);
    if (p == position)
      return line;
    if (*p++ == '\r' && p < scan->end && *p == '\n') {
      if (p == position)
        return line;
      p++;
    }
    line++;
  }
}

vxm_place vxm_tokenizer_place(const vxm_tokenizer *scan, const unsigned char *position) {
  return (vxm_place){scan->name, vxm_tokenizer_line(scan, position), -1, -1};
}

const char *vxm_quote(char quote[VXM_QUOTE], const unsigned char *text, size_t length) {
  size_t shown = length < VXM_QUOTE - 4 ? length : VXM_QUOTE - 4, used = 0;
  for (; used < shown; used++)
    quote[used] = text[used] >= ' ' && text[used] < 0x7f ? (char)text[used] : '?';
  memcpy(quote + used, length > shown ? "..." : "", length > shown ? 4 : 1);
  return quote;
}

/* ---- Damage ---- */

static void note(const vxm_tokenizer *scan, const char *unit, int64_t where, const vxm_text_defect *tally,
                 const char *what, const char *things) {
  if (tally->count > 1)
    vxm_warn(&scan->soup->warnings, "%s %" PRId64 ": %s, %" PRIu64 " such %s in all", unit, where, what,
             tally->count, things);
  else
    vxm_warn(&scan->soup->warnings, "%s %" PRId64 ": %s", unit, where, what);
}

void vxm_text_defect_warn_line(const vxm_tokenizer *scan, const vxm_text_defect *tally, const char *what,
                               const char *things) {
  if (tally->count > 0)
    note(scan, "line", vxm_tokenizer_line(scan, tally->first), tally, what, things);
}

void vxm_text_defect_warn_byte(const vxm_tokenizer *scan, const vxm_text_defect *tally, const char *what,
                               const char *things) {
  if (tally->count > 0)
    note(scan, "byte", (int64_t)(tally->first - scan->begin), tally, what, things);
}

void vxm_warn_text_conversion(const vxm_tokenizer *scan) {
  /* EF BF BD is U+FFFD, which a decoder puts in place of bytes that are no text; in binary data it is rare.
   */
  uint64_t count = 0;
  const unsigned char *p = scan->begin, *first = NULL;
  while (scan->end - p >= 3 && (p = memchr(p, 0xef, (size_t)(scan->end - p) - 2)) != NULL) {
    if (p[1] == 0xbf && p[2] == 0xbd) {
      if (count++ == 0)
        first = p;
      p += 3;
    } else
      p++;
  }
  if (count > 4 && count > (uint64_t)(scan->end - scan->begin) / 1000)
    vxm_warn(&scan->soup->warnings,
             "byte %" PRId64 ": looks ruined by a text conversion (%" PRIu64
             " times U+FFFD); get the file again as binary",
             (int64_t)(first - scan->begin), count);
}

/* ---- Tokens and lines ---- */

const unsigned char *vxm_find_newline(const unsigned char *at, const unsigned char *end) {
  const uint64_t ones = UINT64_C(0x0101010101010101), tops = UINT64_C(0x8080808080808080);
  while (end - at >= 8) {
    uint64_t word = vxm_load8(at), lf = word ^ (ones * '\n'), cr = word ^ (ones * '\r');
    /* The lowest flagged byte of (x - ones) & ~x & tops is the lowest zero byte of x. */
    uint64_t found = (((lf - ones) & ~lf) | ((cr - ones) & ~cr)) & tops;
    if (found)
      return at + (unsigned)__builtin_ctzll(found) / 8;
    at += 8;
  }
  while (at < end && !vxm_is_newline(*at))
    at++;
  return at;
}

size_t vxm_token_length(const vxm_tokenizer *scan) {
  vxm_tokenizer ahead = *scan;
  vxm_skip_token(&ahead);
  return (size_t)(ahead.at - scan->at);
}

size_t vxm_tokens_on_line(const vxm_tokenizer *scan, unsigned char comment) {
  vxm_tokenizer ahead = *scan;
  size_t tokens = 0;
  while (vxm_more_on_line(&ahead) && (comment == 0 || *ahead.at != comment)) {
    tokens++;
    vxm_skip_token(&ahead);
  }
  return tokens;
}

uint64_t vxm_lines_with_data(const vxm_tokenizer *scan, unsigned char comment, uint64_t enough) {
  vxm_tokenizer ahead = *scan;
  uint64_t lines = 0;
  while (lines < enough && vxm_skip_space(&ahead)) {
    lines += comment == 0 || *ahead.at != comment;
    vxm_skip_line(&ahead);
  }
  return lines;
}

uint64_t vxm_lines_of_width(const vxm_tokenizer *scan, unsigned char comment, size_t tokens,
                            uint64_t enough) {
  vxm_tokenizer ahead = *scan;
  uint64_t lines = 0;
  while (lines < enough && vxm_skip_space(&ahead)) {
    if (comment == 0 || *ahead.at != comment) {
      if (vxm_tokens_on_line(&ahead, comment) != tokens)
        break;
      lines++;
    }
    vxm_skip_line(&ahead);
  }
  return lines;
}

enum { SAMPLES = 64, SAMPLE_BYTES = 2048, LINE_BYTES = 4096 };

/** Adds the lines between two positions, each counted `weight` times. */
static void count_lines(vxm_tokenizer ahead, const unsigned char *until, double weight,
                        vxm_line_kinds *kinds) {
  while (vxm_skip_space(&ahead) && ahead.at < until) {
    unsigned char first = *ahead.at & 127;
    bool letter = ahead.end - ahead.at < 2 || ahead.at[1] <= ' ';
    if (letter) {
      kinds->letter[first] += weight;
      kinds->letter_tokens[first] += weight * (double)vxm_tokens_on_line(&ahead, 0);
    } else
      kinds->longer[first] += weight;
    vxm_skip_line(&ahead);
  }
}

void vxm_sample_lines(const vxm_tokenizer *scan, vxm_line_kinds *kinds) {
  *kinds = (vxm_line_kinds){0};
  size_t size = (size_t)(scan->end - scan->begin);
  vxm_tokenizer ahead = *scan;
  if (size <= SAMPLES * SAMPLE_BYTES) {
    ahead.at = scan->begin;
    count_lines(ahead, scan->end, 1.0, kinds);
    return;
  }
  for (size_t s = 0; s < SAMPLES; s++) {
    /* From one line's beginning to another's, so that lines are neither lost nor counted in part. */
    ahead.at = scan->begin + size / SAMPLES * s;
    const unsigned char *until = ahead.at + SAMPLE_BYTES;
    /* No more than a few kilobytes are looked at, however long the lines are. */
    ahead.end = scan->end - until > LINE_BYTES ? until + LINE_BYTES : scan->end;
    if (s > 0)
      vxm_skip_line(&ahead);
    if (ahead.at < until)
      count_lines(ahead, until, (double)(size / SAMPLES) / SAMPLE_BYTES, kinds);
  }
}

/* ---- Numbers ---- */

bool vxm_tokenizer_double_slow(vxm_tokenizer *scan, double *value) {
  const unsigned char *p = scan->at;
  while (p<scan->end && * p> ' ')
    p++;
  if (!vxm_number_parse(scan->at, (size_t)(p - scan->at), value))
    return false;
  scan->at = p;
  return true;
}

uint64_t vxm_tokenizer_uint_long(vxm_tokenizer *scan, uint64_t value) {
  const uint64_t limit = UINT64_C(1) << 63;
  for (; scan->at < scan->end && vxm_is_digit(*scan->at); scan->at++)
    value = value > (limit - 9) / 10 ? limit : value * 10 + (uint64_t)(*scan->at - '0');
  return value;
}

/* ---- Room in the soup ---- */

/** A smaller block never fails to fit, but should the system refuse, the larger one is as good. */
static void trim(vxm_soup *soup, void **array, size_t *capacity, size_t used, size_t size) {
  if (*array == NULL || used == *capacity)
    return;
  void *smaller = vxm_realloc(soup->context, *array, used, size, NULL);
  if (smaller) {
    *array = smaller;
    *capacity = used;
  }
}

void vxm_soup_trim(vxm_soup *soup) {
  trim(soup, (void **)&soup->positions, &soup->vertex_capacity, soup->vertex_count,
       3 * sizeof *soup->positions);
  trim(soup, (void **)&soup->indices, &soup->corner_capacity, soup->corner_count, sizeof *soup->indices);
  size_t offsets = soup->face_capacity + 1;
  trim(soup, (void **)&soup->offsets, &offsets, soup->face_count + 1, sizeof *soup->offsets);
  soup->face_capacity = offsets - 1;
  size_t tags = SIZE_MAX; /* its capacity is the tagger's */
  trim(soup, (void **)&soup->face_tags, &tags, soup->face_count, sizeof *soup->face_tags);
}

size_t vxm_soup_drop_bad_faces(vxm_soup *soup) {
  size_t kept = 0, corners = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    uint64_t begin = soup->offsets[f], end = soup->offsets[f + 1];
    bool good = true;
    for (uint64_t c = begin; c < end; c++)
      good &= soup->indices[c] < soup->vertex_count;
    if (!good)
      continue;
    memmove(soup->indices + corners, soup->indices + begin, (size_t)(end - begin) * sizeof *soup->indices);
    if (soup->appearance)
      vxm_appearance_move_face(soup->appearance, kept, f, corners, (size_t)begin, (size_t)(end - begin));
    corners += (size_t)(end - begin);
    /* kept <= f, so no offset is overwritten before it is read: offsets[f + 1] was read above. */
    if (soup->face_tags)
      soup->face_tags[kept] = soup->face_tags[f];
    soup->offsets[++kept] = corners;
  }
  size_t dropped = soup->face_count - kept;
  soup->face_count = kept;
  soup->corner_count = corners;
  return dropped;
}
