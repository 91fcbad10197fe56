/* SPDX-License-Identifier: BSD-3-Clause */
/** A cursor over the text of a mesh file, and the gathering of what is wrong with it. */
#ifndef VXM_MESHIO_COMMON_TOKENIZER_H
#define VXM_MESHIO_COMMON_TOKENIZER_H

#include "base/number.h"
#include "mesh/soup.h"

/**
 * Line ends are LF, CR LF or CR. Blanks are space, tab, VT and FF. A token is a run of other bytes.
 * Lines are not counted while reading: a position is turned into a line number when a message needs it.
 */
typedef struct vxm_tokenizer {
  const unsigned char *begin, *at, *end;
  const unsigned char *report_at; /**< where progress is told next */
  const char *name;               /**< file, for messages */
  vxm_soup *soup;
} vxm_tokenizer;

/** One that stands at the first byte. */
vxm_tokenizer vxm_tokenizer_of(vxm_soup *soup, const unsigned char *data, size_t size, const char *name);

/** 1-based line of a position. */
int64_t vxm_tokenizer_line(const vxm_tokenizer *scan, const unsigned char *position);
/** Where a failure lies in a text file. */
vxm_place vxm_tokenizer_place(const vxm_tokenizer *scan, const unsigned char *position);

enum { VXM_QUOTE = 48 };

/** The beginning of some text for a message: printable ASCII, with '?' for all else. Returns `quote`. */
const char *vxm_quote(char quote[VXM_QUOTE], const unsigned char *text, size_t length);

/* ---- Damage ---- */

/** One kind of damage: where it was met first and how often. */
typedef struct vxm_text_defect {
  const unsigned char *first;
  uint64_t count;
} vxm_text_defect;

static inline void vxm_text_defect_add(vxm_text_defect *tally, const unsigned char *position) {
  if (tally->count++ == 0)
    tally->first = position;
}

/**
 * Adds "line 12: WHAT" or "line 12: WHAT, 3 THINGS in all" to the warnings; nothing if the tally is empty.
 */
void vxm_text_defect_warn_line(const vxm_tokenizer *scan, const vxm_text_defect *tally, const char *what,
                               const char *things);
/** As vxm_text_defect_warn_line with "byte 123: ". */
void vxm_text_defect_warn_byte(const vxm_tokenizer *scan, const vxm_text_defect *tally, const char *what,
                               const char *things);

/** Notes that the bytes look as if a program had taken them for text, if they do. */
void vxm_warn_text_conversion(const vxm_tokenizer *scan);

/* ---- Progress ---- */

enum { VXM_REPORT_BYTES = 1 << 22 };

vxm_status vxm_tokenizer_report(vxm_tokenizer *scan, vxm_error *error);

/** Tells the progress every few megabytes; VXM_ERROR_CANCELLED if that asks to stop. */
static inline vxm_status vxm_tokenizer_progress(vxm_tokenizer *scan, vxm_error *error) {
  return scan->at < scan->report_at ? VXM_OK : vxm_tokenizer_report(scan, error);
}

/* ---- Blanks, tokens and lines ---- */

static inline bool vxm_is_blank(unsigned char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static inline bool vxm_is_newline(unsigned char c) {
  return c == '\n' || c == '\r';
}

static inline bool vxm_is_digit(unsigned char c) {
  return (unsigned)(c - '0') < 10;
}

static inline void vxm_skip_blanks(vxm_tokenizer *scan) {
  while (scan->at < scan->end && vxm_is_blank(*scan->at))
    scan->at++;
}

static inline bool vxm_at_line_end(const vxm_tokenizer *scan) {
  return scan->at == scan->end || vxm_is_newline(*scan->at);
}

/** Skips blanks and tells whether something is left on the line. */
static inline bool vxm_more_on_line(vxm_tokenizer *scan) {
  vxm_skip_blanks(scan);
  return !vxm_at_line_end(scan);
}

/** Skips blanks and line ends and tells whether anything is left. */
static inline bool vxm_skip_space(vxm_tokenizer *scan) {
  while (scan->at < scan->end && (vxm_is_blank(*scan->at) || vxm_is_newline(*scan->at)))
    scan->at++;
  return scan->at < scan->end;
}

/** The first line end from `at` on, or `end`. */
const unsigned char *vxm_find_newline(const unsigned char *at, const unsigned char *end);

/** Moves to the end of the line, before its line end. */
static inline void vxm_skip_rest(vxm_tokenizer *scan) {
  scan->at = vxm_find_newline(scan->at, scan->end);
}

/** Moves to the beginning of the next line. */
static inline void vxm_skip_line(vxm_tokenizer *scan) {
  vxm_skip_rest(scan);
  if (scan->at < scan->end && *scan->at++ == '\r' && scan->at < scan->end && *scan->at == '\n')
    scan->at++;
}

/** Moves behind the token at the cursor. */
static inline void vxm_skip_token(vxm_tokenizer *scan) {
  while (scan->at < scan->end && !vxm_is_blank(*scan->at) && !vxm_is_newline(*scan->at))
    scan->at++;
}

/** Length of the token at the cursor, which stays. */
size_t vxm_token_length(const vxm_tokenizer *scan);
/** Tokens from the cursor to the end of its line or to a token that begins with `comment` (0 = none). */
size_t vxm_tokens_on_line(const vxm_tokenizer *scan, unsigned char comment);
/** Lines from the cursor on that hold a token, comments not counted; stops counting at `enough`. */
uint64_t vxm_lines_with_data(const vxm_tokenizer *scan, unsigned char comment, uint64_t enough);

/** Lines from the cursor on that have as many tokens each, as vxm_lines_with_data. */
uint64_t vxm_lines_of_width(const vxm_tokenizer *scan, unsigned char comment, size_t tokens, uint64_t enough);

/** About how many lines begin with a word, and how many tokens they have, by the word's first letter. */
typedef struct vxm_line_kinds {
  double letter[128], letter_tokens[128]; /**< words of one letter */
  double longer[128];                     /**< words of more */
} vxm_line_kinds;

/** Extrapolates from samples all over the text, to make room before it is read. */
void vxm_sample_lines(const vxm_tokenizer *scan, vxm_line_kinds *kinds);

/* ---- Numbers ---- */

bool vxm_tokenizer_double_slow(vxm_tokenizer *scan, double *value);

/**
 * Reads the number at the cursor, which stands on a token, and moves behind it. If the token is not a number
 * as a whole the cursor stays, and the answer is false.
 */
static inline bool vxm_tokenizer_double(vxm_tokenizer *scan, double *value) {
  const unsigned char *p = scan->at;
  if (scan->end - p < 40) /* a sign, 8 + 1 + 16 digits, an exponent, and what loads take beyond */
    return vxm_tokenizer_double_slow(scan, value);
  bool negative = *p == '-';
  p += negative;
  uint64_t word = vxm_load8(p);
  unsigned whole = vxm_leading_digits(word), places = 0;
  uint64_t w = whole ? vxm_digits_value(word, whole) : 0;
  p += whole;
  if (*p == '.') {
    p++;
    word = vxm_load8(p);
    places = vxm_leading_digits(word);
    if (places) {
      w = w * vxm_pow10_u64[places] + vxm_digits_value(word, places);
      p += places;
    }
    if (places == 8) {
      word = vxm_load8(p);
      unsigned more = vxm_leading_digits(word);
      if (more) {
        w = w * vxm_pow10_u64[more] + vxm_digits_value(word, more);
        p += more;
        places += more;
      }
    }
  }
  int exponent = -(int)places;
  if ((*p | 0x20) == 'e' && (p[1] == '-' || p[1] == '+') && vxm_is_digit(p[2]) && vxm_is_digit(p[3])) {
    int size = 10 * (p[2] - '0') + (p[3] - '0');
    exponent += p[1] == '-' ? -size : size;
    p += 4;
  }
  /* Not for this path: words, more than 19 digits (w may have wrapped), other exponents. */
  if (*p > ' ' || whole + places - 1u > 18u)
    return vxm_tokenizer_double_slow(scan, value);
  double result;
  if (__builtin_expect(w <= UINT64_C(1) << 53 && exponent <= 0 && exponent >= -22, 1))
    result = (double)w / vxm_pow10[-exponent];
  else if (!vxm_decimal(w, exponent, &result))
    return vxm_tokenizer_double_slow(scan, value);
  *value = negative ? -result : result;
  scan->at = p;
  return true;
}

uint64_t vxm_tokenizer_uint_long(vxm_tokenizer *scan, uint64_t value);

/** Reads the digits at the cursor; false if there are none. Beyond 2^63 the value is 2^63. */
static inline bool vxm_tokenizer_digits(vxm_tokenizer *scan, uint64_t *value) {
  const unsigned char *p = scan->at;
  if (scan->end - p >= 9) {
    uint64_t word = vxm_load8(p);
    unsigned n = vxm_leading_digits(word);
    if (n == 0)
      return false;
    *value = vxm_digits_value(word, n);
    scan->at = p + n;
    if (__builtin_expect(n == 8, 0))
      *value = vxm_tokenizer_uint_long(scan, *value);
    return true;
  }
  if (p == scan->end || !vxm_is_digit(*p))
    return false;
  *value = vxm_tokenizer_uint_long(scan, 0);
  return true;
}

/** Reads a token that is a whole number without a sign; if it is not, the cursor stays. */
static inline bool vxm_tokenizer_uint(vxm_tokenizer *scan, uint64_t *value) {
  const unsigned char *before = scan->at;
  if (vxm_tokenizer_digits(scan, value) && (scan->at == scan->end || *scan->at <= ' '))
    return true;
  scan->at = before;
  return false;
}

/* ---- Room in the soup ---- */

/** Makes room for `more` corners behind those there are. */
static inline vxm_status vxm_corners_reserve(vxm_soup *soup, size_t more, vxm_error *error) {
  if (__builtin_expect(more <= soup->corner_capacity - soup->corner_count, 1))
    return VXM_OK;
  return vxm_soup_reserve(soup, 0, 0, soup->corner_count + more, error);
}

/** Ends a face whose corners were written behind corner_count. */
static inline vxm_status vxm_face_end(vxm_soup *soup, size_t corners, vxm_error *error) {
  if (__builtin_expect(soup->face_count == soup->face_capacity, 0)) {
    vxm_status status = vxm_soup_reserve(soup, 0, soup->face_count + 1, 0, error);
    if (status != VXM_OK)
      return status;
  }
  soup->corner_count += corners;
  soup->offsets[++soup->face_count] = soup->corner_count;
  return VXM_OK;
}

/** Gives unused room back. */
void vxm_soup_trim(vxm_soup *soup);

/** Removes the faces that name a vertex beyond the last; returns how many those were. */
size_t vxm_soup_drop_bad_faces(vxm_soup *soup);

#endif
