/* SPDX-License-Identifier: BSD-3-Clause */
/** Count and hash against their definition voxel by voxel, in all layouts, windows and numbers of threads. */
#include "../gridio/grids.h"

#include "base/hash.h"
#include "grid/count_hash.h"

static const vxm_layout layouts[6] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

/** The definition in doc/conventions.md, one voxel at a time. */
static vxm_count_hash plain_sum(const vxm_grid *grid) {
  const int64_t *n = grid->space.dims;
  vxm_count_hash sum = {0, 0};
  for (int a = 0; a < 3; a++)
    sum.hash = vxm_hash_word(sum.hash, (uint64_t)n[a]);
  for (int64_t k = 0; k < n[2]; k++)
    for (int64_t j = 0; j < n[1]; j++)
      for (int64_t i = 0; i < n[0]; i++) {
        sum.count += vxm_grid_get(grid, i, j, k);
        if (vxm_grid_get(grid, i, j, k) != vxm_grid_get(grid, i - 1, j, k))
          sum.hash += vxm_hash_word(0, (uint64_t)((k * n[1] + j) * n[0] + i));
      }
  return sum;
}

/** Slices begin..end-1 of a grid in a layout; the words are to be freed. Gaps between slices hold noise. */
static vxm_window cut(const vxm_grid *grid, vxm_layout layout, int64_t begin, int64_t end) {
  vxm_window window = vxm_window_of(&grid->space, layout, begin, end);
  window.slice_words += (size_t)(begin % 3);
  window.words = calloc((size_t)(end - begin) * window.slice_words + 1, sizeof *window.words);
  assert_non_null(window.words);
  int64_t p[3];
  for (p[2] = 0; p[2] < grid->space.dims[2]; p[2]++)
    for (p[1] = 0; p[1] < grid->space.dims[1]; p[1]++)
      for (p[0] = 0; p[0] < grid->space.dims[0]; p[0]++) {
        int64_t fast = p[layout.fast], middle = p[layout.middle], slow = p[layout.slow];
        if (slow >= begin && slow < end && vxm_grid_get(grid, p[0], p[1], p[2]))
          vxm_window_row(&window, middle, slow)[fast / 64] |= UINT64_C(1) << (fast % 64);
      }
  for (int64_t s = begin; s < end; s++)
    for (size_t w = window.row_words * (size_t)window.middle_dim; w < window.slice_words; w++)
      vxm_window_row(&window, 0, s)[w] = ~UINT64_C(0);
  return window;
}

static void assert_same(vxm_count_hash a, vxm_count_hash b) {
  assert_true(a.count == b.count);
  assert_true(a.hash == b.hash);
}

/** One window after the other, each with the last slice of the one before; by threads, or cut once more. */
static vxm_count_hash sum_in_windows(const vxm_grid *grid, vxm_layout layout, vxm_context *context,
                                     vxm_rng *rng) {
  vxm_count_hash sum = vxm_count_hash_start(&grid->space);
  int64_t slices = grid->space.dims[layout.slow];
  vxm_window before = {.words = NULL};
  for (int64_t begin = 0, end; begin < slices; begin = end) {
    end = begin + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(slices - begin));
    vxm_window window = cut(grid, layout, begin, end);
    const uint64_t *last = begin > 0 ? vxm_window_row(&before, 0, begin - 1) : NULL;
    if (vxm_rng_below(rng, 2) == 0)
      vxm_count_hash_add(&sum, context, &window, last);
    else {
      int64_t middle = begin + (int64_t)vxm_rng_below(rng, (uint64_t)(end - begin + 1));
      vxm_count_hash part = {0, 0};
      vxm_window first = window, second = window;
      first.end = second.begin = middle;
      second.words = vxm_window_row(&window, 0, middle);
      vxm_count_hash_add(&part, context, &second,
                         middle > begin ? vxm_window_row(&window, 0, middle - 1) : last);
      vxm_count_hash_add(&sum, context, &first, last); /* in any order */
      vxm_count_hash_join(&sum, part);
    }
    free(before.words);
    before = window;
  }
  free(before.words);
  return sum;
}

static void test_layouts_and_windows(void **state) {
  (void)state;
  static const int64_t sides[] = {1, 2, 63, 64, 65, 130};
  vxm_context *contexts[3];
  for (int c = 0; c < 3; c++)
    contexts[c] = context_with(1 + 2 * c, 0, NULL, NULL);
  vxm_rng rng = {51};
  for (int round = 0; round < 90; round++) {
    int64_t side[3];
    for (int a = 0; a < 3; a++)
      side[a] = sides[vxm_rng_below(&rng, 6)];
    if (side[0] * side[1] * side[2] > 300000)
      side[vxm_rng_below(&rng, 3)] = 3;
    vxm_grid *grid = new_grid(contexts[round % 3], unit_space(side[0], side[1], side[2]));
    fill_random(grid, &rng, round % KINDS);
    vxm_count_hash expected = plain_sum(grid), whole;
    vxm_grid_count_hash(grid, &whole.count, &whole.hash);
    assert_same(whole, expected);
    for (int l = 0; l < 6; l++)
      assert_same(sum_in_windows(grid, layouts[l], contexts[(round + l) % 3], &rng), expected);
    vxm_grid_destroy(grid);
  }
  for (int c = 0; c < 3; c++)
    vxm_context_destroy(contexts[c]);
}

/** Long rows have whole blocks without a step; many tasks share the work. */
static void test_large(void **state) {
  (void)state;
  vxm_rng rng = {52};
  for (int round = 0; round < 4; round++) {
    vxm_context *context = context_with(1 + round, 0, NULL, NULL);
    static const int64_t dims[4][3] = {{1500, 40, 9}, {9, 1500, 40}, {40, 9, 1500}, {100001, 2, 3}};
    vxm_grid *grid = new_grid(context, unit_space(dims[round][0], dims[round][1], dims[round][2]));
    fill_random(grid, &rng, 2);
    for (int l = 0; l < 6; l++) {
      vxm_window window = cut(grid, layouts[l], 0, grid->space.dims[layouts[l].slow]);
      vxm_count_hash sum = vxm_count_hash_start(&grid->space);
      vxm_count_hash_add(&sum, context, &window, NULL);
      assert_same(sum, plain_sum(grid));
      free(window.words);
    }
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
}

/** Any one voxel changes the hash of any grid, each in its own way. */
static int compare_words(const void *a, const void *b) {
  const uint64_t *p = a, *q = b;
  return *p < *q ? -1 : *p > *q;
}

static void test_every_bit_counts(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {53};
  static uint64_t seen[70 * 5 * 4 + 1];
  for (int kind = 0; kind < KINDS; kind++) {
    vxm_grid *grid = new_grid(context, unit_space(70, 5, 4));
    fill_random(grid, &rng, kind);
    size_t count = 0;
    seen[count++] = vxm_grid_hash(grid);
    for (int64_t v = 0; v < 70 * 5 * 4; v++) {
      int64_t i = v % 70, j = v / 70 % 5, k = v / 350;
      bool was = vxm_grid_get(grid, i, j, k);
      vxm_grid_set(grid, i, j, k, !was);
      seen[count++] = vxm_grid_hash(grid);
      vxm_grid_set(grid, i, j, k, was);
    }
    qsort(seen, count, sizeof *seen, compare_words);
    for (size_t s = 1; s < count; s++)
      assert_true(seen[s] != seen[s - 1]);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_layouts_and_windows),
      cmocka_unit_test(test_large),
      cmocka_unit_test(test_every_bit_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
