/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows of voxels from where parts begin and end in rows of sub-voxels, against each sub-voxel by itself. */
#include "shapes.h"

#include "base/rng.h"
#include "voxel/fields/coverage_flips.h"

#include <stdlib.h>

enum { PARTS = 5, PLACES = 400, GUARD = 64 };

/** Places of a part; those of other parts lie about the same voxels, so that parts overlap. */
static size_t make_places(uint64_t *places, const vxm_coverage_flips *f, size_t rows, vxm_rng *rng) {
  size_t count = (size_t)vxm_rng_below(rng, PLACES), n = (size_t)1 << f->shift;
  uint64_t row = vxm_rng_below(rng, rows), about = vxm_rng_below(rng, f->row_length);
  for (size_t i = 0; i < count; i++) {
    if (vxm_rng_below(rng, 8) == 0)
      row = vxm_rng_below(rng, rows);
    if (vxm_rng_below(rng, 16) == 0)
      about = vxm_rng_below(rng, f->row_length);
    uint64_t at = about * n + vxm_rng_below(rng, 3 * n);
    at = at < f->row_length * n ? at : vxm_rng_below(rng, f->row_length * n);
    places[i] = (row * n * n + vxm_rng_below(rng, n * n)) << f->place_bits | at;
    if (i > 0 && vxm_rng_below(rng, 20) == 0)
      places[i] = places[i - 1]; /* begins and ends in one place */
  }
  return count;
}

/** Sets the sub-voxels of a part, one after the other; returns whether there is one. */
static bool set_bytes(unsigned char *set, const vxm_coverage_flips *f, size_t rows, const uint64_t *places,
                      size_t count) {
  size_t n = (size_t)1 << f->shift, length = f->row_length * n, lines = rows * n * n;
  unsigned char *flipped = calloc(lines, length);
  bool any = false;
  for (size_t i = 0; i < count; i++)
    flipped[(places[i] >> f->place_bits) * length + (places[i] & (((uint64_t)1 << f->place_bits) - 1))] ^= 1;
  for (size_t line = 0; line < lines; line++)
    for (size_t at = 0, inside = 0; at < length; at++) {
      inside ^= flipped[line * length + at];
      set[line * length + at] |= (unsigned char)inside;
      any |= inside != 0;
    }
  free(flipped);
  return any;
}

/** Sub-voxels of a voxel that are set. */
static unsigned count_set(const unsigned char *set, const vxm_coverage_flips *f, size_t row, size_t voxel) {
  size_t n = (size_t)1 << f->shift, length = f->row_length * n;
  unsigned count = 0;
  for (size_t line = row * n * n; line < (row + 1) * n * n; line++)
    for (size_t at = voxel * n; at < (voxel + 1) * n; at++)
      count += set[line * length + at];
  return count;
}

typedef struct outcome {
  unsigned char *bytes; /**< the values, and GUARD bytes around them */
  vxm_coverage_tally tally;
} outcome;

static void check_values(const outcome *got, const vxm_coverage_values *values, size_t number, size_t before,
                         const unsigned char *set, const vxm_coverage_flips *f, size_t rows) {
  int64_t subvoxels = 0, full = 0, partial = 0;
  unsigned most = 1U << 3 * f->shift;
  const unsigned char *at = got->bytes + before;
  for (size_t row = 0; row < rows; row++)
    for (size_t voxel = 0; voxel < f->row_length; voxel++, at += number) {
      unsigned count = count_set(set, f, row, voxel);
      float fraction = (float)count / (float)most;
      assert_memory_equal(at, number == 1 ? (const void *)&values->bytes[count] : &fraction, number);
      subvoxels += count;
      full += count == most;
      partial += count > 0 && count < most;
    }
  for (size_t i = 0; i < GUARD; i++)
    assert_true(got->bytes[before - 1 - i] == 0xa5 && at[i] == 0xa5);
  assert_int_equal(got->tally.subvoxels, subvoxels);
  assert_int_equal(got->tally.full, full);
  assert_int_equal(got->tally.partial, partial);
}

/** All rows, `some` at a time, as parts of which each is united with those before it. */
static void check_rows(vxm_rng *rng, int n, vxm_scalar scalar, bool streaming) {
  vxm_coverage_flips shape = vxm_coverage_flips_of(n, 1 + (size_t)vxm_rng_below(rng, n == 8 ? 80 : 300));
  size_t rows = 1 + (size_t)vxm_rng_below(rng, 5), some = 1 + (size_t)vxm_rng_below(rng, rows), count[PARTS];
  size_t number = vxm_scalar_bytes(scalar), size = rows * shape.row_length * number;
  size_t before = GUARD + number * (size_t)vxm_rng_below(rng, 40);
  unsigned char *set = calloc(rows * shape.row_length, (size_t)(n * n * n));
  uint64_t places[PARTS][PLACES];
  bool any[PARTS];
  int parts = (int)vxm_rng_below(rng, PARTS + 1);
  for (int p = 0; p < parts; p++) {
    count[p] = make_places(places[p], &shape, rows, rng);
    any[p] = set_bytes(set, &shape, rows, places[p], count[p]);
  }
  outcome got = {.bytes = aligned_alloc(64, (before + size + 2 * GUARD) / 64 * 64)};
  memset(got.bytes, 0xa5, before + size + GUARD);
  vxm_coverage_values values = vxm_coverage_values_of(n, scalar);
  values.out = got.bytes + before;
  values.streaming = streaming;
  vxm_coverage_flips all = shape, part = shape;
  assert_int_equal(vxm_coverage_flips_make(&all, context, some, NULL), VXM_OK);
  assert_int_equal(vxm_coverage_flips_make(&part, context, some, NULL), VXM_OK);
  vxm_coverage_writer writer;
  vxm_coverage_writer_begin(&writer, &values, 0, &got.tally);
  bool seen[PARTS] = {false};
  for (size_t row = 0; row < rows; row += some) {
    for (int p = 0; p < parts; p++) {
      vxm_coverage_flips *f = p == 0 ? &all : &part;
      vxm_coverage_flip(f, row, places[p], count[p]);
      seen[p] |= vxm_coverage_flips_any(f);
      if (p > 0)
        vxm_coverage_flips_unite(&all, f);
    }
    vxm_coverage_put_rows(&all, rows - row < some ? rows - row : some, &writer);
  }
  vxm_coverage_writer_end(&writer);
  check_values(&got, &values, number, before, set, &shape, rows);
  for (int p = 0; p < parts; p++)
    assert_int_equal(seen[p], any[p]);
  vxm_coverage_flips_destroy(&part, context);
  vxm_coverage_flips_destroy(&all, context);
  free(got.bytes);
  free(set);
}

static void test_equals_counting(void **state) {
  (void)state;
  vxm_rng rng = {5};
  for (int round = 0; round < 600; round++)
    check_rows(&rng, 2 << round % 3, round / 3 % 2 ? VXM_UINT8 : VXM_FLOAT32, round / 6 % 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_equals_counting)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
