/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of mesh reading and writing share. */
#ifndef MESHIO_TEST_H
#define MESHIO_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "meshio/meshio.h"

/* ---- Bytes that grow ---- */

typedef struct bytes {
  unsigned char *data;
  size_t size, capacity;
} bytes;

static inline void bytes_add(bytes *b, const void *data, size_t size) {
  if (size > b->capacity - b->size) {
    b->capacity = 2 * b->capacity + size;
    b->data = realloc(b->data, b->capacity);
    assert_non_null(b->data);
  }
  if (size > 0)
    memcpy(b->data + b->size, data, size);
  b->size += size;
}

static inline void bytes_text(bytes *b, const char *format, ...) VXM_PRINTF(2, 3);
static inline void bytes_text(bytes *b, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  assert_true(length >= 0 && (size_t)length < sizeof text);
  bytes_add(b, text, (size_t)length);
}

static inline void bytes_free(bytes *b) {
  free(b->data);
  *b = (bytes){NULL, 0, 0};
}

/* ---- Reading ---- */

static inline void check_invariants(const vxm_soup *soup) {
  assert_non_null(soup->offsets);
  assert_true(soup->offsets[0] == 0);
  for (size_t f = 0; f < soup->face_count; f++) {
    assert_true(soup->offsets[f] <= soup->offsets[f + 1]);
    assert_true(soup->offsets[f + 1] - soup->offsets[f] >= 3); /* readers keep no smaller faces */
  }
  assert_true(soup->offsets[soup->face_count] == soup->corner_count);
  for (size_t c = 0; c < soup->corner_count; c++)
    assert_true(soup->indices[c] < soup->vertex_count);
  assert_true((soup->face_tags != NULL) == (soup->tag_count > 0));
  for (size_t f = 0; soup->face_tags && f < soup->face_count; f++)
    assert_true(soup->face_tags[f] < soup->tag_count);
}

/** Reads a copy of exactly the given size, so that a sanitizer sees every byte read beyond the end. */
static inline vxm_status read_bytes(vxm_soup **soup, const void *data, size_t size, const char *name,
                                    vxm_error *error) {
  unsigned char *copy = malloc(size ? size : 1);
  assert_non_null(copy);
  if (size > 0)
    memcpy(copy, data, size);
  *error = (vxm_error)VXM_ERROR_INIT;
  vxm_status status = vxm_meshio_read(soup, NULL, copy, size, name, NULL, error);
  free(copy);
  assert_int_equal(status, status == VXM_OK ? VXM_OK : error->code);
  if (status == VXM_OK)
    check_invariants(*soup);
  else {
    assert_null(*soup);
    assert_true(strlen(error->text) > 0);
    assert_null(strchr(error->text, '\n'));
  }
  return status;
}

static inline vxm_soup *read_data(const void *data, size_t size, const char *name) {
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  if (read_bytes(&soup, data, size, name, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return soup;
}

static inline vxm_soup *read_text(const char *text, const char *name) {
  return read_data(text, strlen(text), name);
}

/** Expects a failure of the given kind whose message contains `part`. */
static inline void read_fails(const void *data, size_t size, const char *name, vxm_status expected,
                              const char *part) {
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = read_bytes(&soup, data, size, name, &error);
  if (status != expected || !strstr(error.text, part))
    fail_msg("status %d, message \"%s\", expected \"%s\"", status, error.text, part);
}

static inline void text_fails(const char *text, const char *name, const char *part) {
  read_fails(text, strlen(text), name, VXM_ERROR_FORMAT, part);
}

static inline void expect_counts(const vxm_soup *soup, size_t vertices, size_t faces) {
  assert_int_equal(soup->vertex_count, vertices);
  assert_int_equal(soup->face_count, faces);
}

static inline void expect_face(const vxm_soup *soup, size_t face, size_t count, ...) {
  size_t n;
  const uint32_t *corner = vxm_face(soup, face, &n);
  assert_int_equal(n, count);
  va_list arguments;
  va_start(arguments, count);
  for (size_t c = 0; c < n; c++)
    assert_int_equal(corner[c], va_arg(arguments, int));
  va_end(arguments);
}

static inline void expect_vertex(const vxm_soup *soup, size_t vertex, double x, double y, double z) {
  const double *p = vxm_position(soup, vertex), expected[3] = {x, y, z};
  for (int c = 0; c < 3; c++)
    assert_true(p[c] == expected[c] || (isnan(p[c]) && isnan(expected[c])));
}

static inline void expect_warning(const vxm_soup *soup, const char *part) {
  for (int n = 0; n < soup->warnings.count; n++)
    if (strstr(soup->warnings.text[n], part))
      return;
  fail_msg("no warning \"%s\" among %d; first: \"%s\"", part, soup->warnings.count,
           soup->warnings.count ? soup->warnings.text[0] : "");
}

static inline void expect_no_warnings(const vxm_soup *soup) {
  if (soup->warnings.count)
    fail_msg("unexpected warning \"%s\"", soup->warnings.text[0]);
}

/** As expect_no_warnings for soups made at random, with vertices that no face uses, or that are not finite.
 */
static inline void expect_no_damage(const vxm_soup *soup) {
  for (int n = 0; n < soup->warnings.count; n++)
    if (!strstr(soup->warnings.text[n], "may be cut off: no face uses") &&
        !strstr(soup->warnings.text[n], "that is not finite"))
      fail_msg("unexpected warning \"%s\"", soup->warnings.text[n]);
}

/* ---- Random soups ---- */

static inline double bits_to_double(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline uint64_t double_to_bits(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

/** Finite numbers of every kind: short decimals, integers, floats and any bit pattern at all. */
static inline double random_number(vxm_rng *rng) {
  switch (vxm_rng_below(rng, 5)) {
  case 0:
    return (double)((int64_t)vxm_rng_below(rng, 2000001) - 1000000) / 1000.0;
  case 1:
    return (double)((int64_t)vxm_rng_below(rng, 201) - 100);
  case 2:
    return (double)(float)(vxm_rng_unit(rng) * 10.0 - 5.0);
  case 3:
    return vxm_rng_unit(rng) * 2.0 - 1.0;
  default:
    for (;;) {
      double value = bits_to_double(vxm_rng_next(rng));
      if (isfinite(value))
        return value;
    }
  }
}

static inline vxm_soup *random_soup(vxm_rng *rng, size_t vertices, size_t faces, size_t corners_max) {
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, NULL, "arrays", NULL), VXM_OK);
  for (size_t v = 0; v < vertices; v++) {
    double x = random_number(rng), y = random_number(rng), z = random_number(rng);
    assert_int_equal(vxm_soup_add_vertex(soup, x, y, z, NULL), VXM_OK);
  }
  uint32_t corner[512];
  for (size_t f = 0; f < faces; f++) {
    size_t n = vxm_rng_below(rng, 3) ? 3 : 3 + (size_t)vxm_rng_below(rng, corners_max - 2);
    for (size_t c = 0; c < n; c++)
      corner[c] = (uint32_t)vxm_rng_below(rng, vertices);
    assert_int_equal(vxm_soup_add_face(soup, corner, n, NULL), VXM_OK);
  }
  return soup;
}

static inline void expect_same_faces(const vxm_soup *a, const vxm_soup *b) {
  assert_int_equal(a->face_count, b->face_count);
  assert_int_equal(a->corner_count, b->corner_count);
  assert_memory_equal(a->offsets, b->offsets, (a->face_count + 1) * sizeof *a->offsets);
  if (a->corner_count)
    assert_memory_equal(a->indices, b->indices, a->corner_count * sizeof *a->indices);
}

/** Bit for bit. */
static inline void expect_same(const vxm_soup *a, const vxm_soup *b) {
  assert_int_equal(a->vertex_count, b->vertex_count);
  if (a->vertex_count)
    assert_memory_equal(a->positions, b->positions, 3 * a->vertex_count * sizeof *a->positions);
  expect_same_faces(a, b);
}

#endif
