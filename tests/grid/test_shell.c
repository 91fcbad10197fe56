/* SPDX-License-Identifier: BSD-3-Clause */
/* The shells of random solids against a look at every neighbour of every voxel. */
#include "base/rng.h"
#include "grid/shell.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SPARE = 0x55 };

static bool get(const vxm_window *w, int64_t f, int64_t m, int64_t s) {
  if (f < 0 || m < 0 || s < 0 || f >= w->fast_dim || m >= w->middle_dim || s >= w->slow_dim)
    return false;
  return vxm_window_row(w, m, s)[f / 64] >> (f % 64) & 1;
}

static bool is_shell(const vxm_window *w, int64_t f, int64_t m, int64_t s, int adjacency) {
  for (int a = -1; a <= 1; a++)
    for (int b = -1; b <= 1; b++)
      for (int c = -1; c <= 1; c++) {
        int steps = abs(a) + abs(b) + abs(c);
        bool is_adjacent = steps > 0 && steps <= (adjacency == 6 ? 1 : adjacency == 18 ? 2 : 3);
        if (is_adjacent && !get(w, f + a, m + b, s + c))
          return get(w, f, m, s);
      }
  return false;
}

/** Mostly set, in blocks or voxel by voxel, so that there is an inside. */
static void fill(const vxm_window *w, vxm_rng *rng, int kind) {
  for (int64_t s = 0; s < w->slow_dim; s++)
    for (int64_t m = 0; m < w->middle_dim; m++)
      for (int64_t f = 0; f < w->fast_dim; f++) {
        bool is_set = kind == 0   ? vxm_rng_below(rng, 2) == 0
                      : kind == 1 ? vxm_rng_below(rng, 40) != 0
                      : kind == 2 ? vxm_mix((uint64_t)(f / 6 + 100 * (m / 4) + 10000 * (s / 3))) % 4 != 0
                                  : kind == 3;
        vxm_window_row(w, m, s)[f / 64] |= (uint64_t)is_set << (f % 64);
      }
}

static void check(const vxm_window *solid, vxm_adjacency adjacency, int64_t begin, int64_t end,
                  vxm_context *context) {
  /* Only the slices that may be looked at are there. */
  vxm_window part = *solid, out = *solid;
  part.begin = vxm_max(begin - 1, 0);
  part.end = vxm_min(end + 1, solid->slow_dim);
  size_t count = (size_t)(part.end - part.begin) * solid->slice_words;
  part.words = malloc(count * sizeof *part.words);
  memcpy(part.words, vxm_window_row(solid, 0, part.begin), count * sizeof *part.words);
  out.begin = begin;
  out.end = end;
  size_t size = (size_t)(end - begin) * solid->slice_words * sizeof *out.words;
  out.words = malloc(size);
  memset(out.words, SPARE, size);
  vxm_shell_fill(&out, &part, adjacency, context);
  for (int64_t s = begin; s < end; s++)
    for (int64_t m = 0; m < solid->middle_dim; m++) {
      for (int64_t f = 0; f < solid->fast_dim; f++)
        assert_int_equal(get(&out, f, m, s), is_shell(solid, f, m, s, (int)adjacency));
      assert_true((vxm_window_row(&out, m, s)[out.row_words - 1] & ~vxm_window_tail_mask(&out)) == 0);
    }
  free(out.words);
  free(part.words);
}

static void test_every_neighbour_is_looked_at(void **state) {
  (void)state;
  static const vxm_adjacency adjacencies[] = {VXM_ADJACENT_6, VXM_ADJACENT_18, VXM_ADJACENT_26};
  static const int64_t lengths[] = {1, 2, 63, 64, 65, 127, 128, 130, 200};
  vxm_rng rng = {7};
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = 3;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  for (int round = 0; round < 90; round++) {
    vxm_space space = {.dims = {1 + (int64_t)vxm_rng_below(&rng, 12), lengths[round % 9],
                                1 + (int64_t)vxm_rng_below(&rng, 9)}};
    vxm_window solid = vxm_window_of(&space, (vxm_layout){1, 0, 2}, 0, space.dims[2]);
    solid.words = calloc((size_t)solid.end * solid.slice_words, sizeof *solid.words);
    fill(&solid, &rng, round % 5);
    int64_t cut = (int64_t)vxm_rng_below(&rng, (uint64_t)solid.end);
    for (int a = 0; a < 3; a++) {
      check(&solid, adjacencies[a], 0, solid.end, context);
      check(&solid, adjacencies[a], 0, cut, context);
      check(&solid, adjacencies[a], cut, solid.end, context);
    }
    free(solid.words);
  }
  vxm_context_destroy(context);
}

/** Rows longer than the block that is worked on at once. */
static void test_long_rows(void **state) {
  (void)state;
  vxm_rng rng = {8};
  vxm_space space = {.dims = {64 * 129 + 5, 4, 4}};
  vxm_window solid = vxm_window_of(&space, (vxm_layout)VXM_LAYOUT_GRID, 0, 4);
  solid.words = calloc((size_t)solid.end * solid.slice_words, sizeof *solid.words);
  fill(&solid, &rng, 1);
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  check(&solid, VXM_ADJACENT_6, 0, 4, context);
  check(&solid, VXM_ADJACENT_18, 0, 4, context);
  check(&solid, VXM_ADJACENT_26, 1, 3, context);
  vxm_context_destroy(context);
  free(solid.words);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_neighbour_is_looked_at),
      cmocka_unit_test(test_long_rows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
