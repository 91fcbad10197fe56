/* SPDX-License-Identifier: BSD-3-Clause */
/** Rows of bits as numbers, voxel by voxel, in the cache and past it; nothing is written beside them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "augment/unpack_bits.h"
#include "base/rng.h"

enum { ROWS = 5, LONGEST = 200, ROW_WORDS_MOST = 4, ROOM = ROWS * LONGEST * 4, GUARD = 64, FILL = 0xa5 };

static uint64_t words[ROWS * ROW_WORDS_MOST];
static _Alignas(64) unsigned char out[ROOM + 2 * GUARD];

/** Each word none, all or some of its voxels; those behind the row none. */
static void draw_words(vxm_rng *rng, size_t row_words, int64_t dim) {
  for (size_t w = 0; w < ROWS * row_words; w++) {
    uint64_t kind = vxm_rng_below(rng, 3), some = 0;
    for (int bit = 0; bit < 64; bit++)
      some |= (uint64_t)vxm_rng_below(rng, 2) << bit;
    words[w] = kind == 0 ? 0 : kind == 1 ? ~UINT64_C(0) : some;
    int64_t left = dim - (int64_t)(64 * (w % row_words));
    if (left < 64)
      words[w] &= (UINT64_C(1) << left) - 1;
  }
}

static void expect_voxels(const unsigned char *at, vxm_voxel_format voxels, size_t row_words, int64_t dim) {
  size_t step = vxm_unpack_row_bytes(voxels, dim);
  for (size_t r = 0; r < ROWS; r++, at += step)
    for (size_t i = 0; i < (size_t)dim; i++) {
      unsigned expected = (unsigned)(words[r * row_words + i / 64] >> (i % 64) & 1);
      float number;
      memcpy(&number, voxels == VXM_VOXEL_FORMAT_FLOAT32 ? at + 4 * i : at, sizeof number);
      if (voxels == VXM_VOXEL_FORMAT_FLOAT32)
        assert_true(number == (float)expected);
      else if (voxels == VXM_VOXEL_FORMAT_UINT8)
        assert_int_equal(at[i], expected);
      else
        assert_int_equal(at[i / 8] >> (i % 8) & 1, expected);
    }
}

static void all_forms(void **state) {
  (void)state;
  static const int formats[] = {VXM_VOXEL_FORMAT_PACKED, VXM_VOXEL_FORMAT_UINT8, VXM_VOXEL_FORMAT_FLOAT32};
  vxm_rng rng = {8};
  for (int64_t dim = 1; dim <= LONGEST; dim++)
    for (int f = 0; f < 3; f++)
      for (size_t shift = 0; shift < 16; shift += 4)
        for (int past = 0; past < 2; past++) {
          vxm_voxel_format voxels = (vxm_voxel_format)formats[f];
          size_t row_words = ((size_t)dim + 63) / 64, bytes = ROWS * vxm_unpack_row_bytes(voxels, dim);
          unsigned char *at = out + GUARD + shift;
          draw_words(&rng, row_words, dim);
          memset(out, FILL, sizeof out);
          vxm_unpack_row(at, voxels, words, ROWS, dim, past);
          expect_voxels(at, voxels, row_words, dim);
          for (size_t i = 0; i < sizeof out; i++)
            if (out + i < at || out + i >= at + bytes)
              assert_int_equal(out[i], FILL);
        }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(all_forms)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
