/* SPDX-License-Identifier: BSD-3-Clause */
/** Octrees against dense grids: voxel by voxel, in windows of all layouts, and by set operations. */
#include "../gridio/grids.h"

#include "base/endian.h"
#include "grid/octree_build.h"

static const vxm_layout layouts[6] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
static const int threads[3] = {1, 2, 7};
static vxm_context *contexts[3];

static int setup(void **state) {
  (void)state;
  for (int c = 0; c < 3; c++)
    contexts[c] = context_with(threads[c], 0, NULL, NULL);
  return 0;
}

static int teardown(void **state) {
  (void)state;
  for (int c = 0; c < 3; c++)
    vxm_context_destroy(contexts[c]);
  return 0;
}

static vxm_sparse *octree_of(const vxm_grid *grid) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_sparse *sparse;
  if (vxm_sparse_from_grid(&sparse, grid, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return sparse;
}

static vxm_grid *random_grid(vxm_context *context, vxm_rng *rng, int kind) {
  static const int64_t sides[] = {1, 3, 4, 5, 15, 16, 17, 63, 64, 65, 130};
  int64_t side[3];
  for (int a = 0; a < 3; a++)
    side[a] = sides[vxm_rng_below(rng, sizeof sides / sizeof *sides)];
  if (side[0] * side[1] * side[2] > 200000)
    side[vxm_rng_below(rng, 3)] = 5;
  vxm_grid *grid = new_grid(context, unit_space(side[0], side[1], side[2]));
  fill_random(grid, rng, kind);
  return grid;
}

/** The form is canonical: equal sets have equal words. */
static void assert_same_octree(const vxm_sparse *a, const vxm_sparse *b) {
  assert_int_equal(a->levels, b->levels);
  assert_int_equal(a->brick_count, b->brick_count);
  if (a->brick_count > 0)
    assert_memory_equal(a->bricks, b->bricks, a->brick_count * sizeof *a->bricks);
  for (int l = 0; l < a->levels; l++) {
    assert_int_equal(a->node_count[l], b->node_count[l]);
    if (a->node_count[l] > 0)
      assert_memory_equal(a->nodes[l], b->nodes[l], a->node_count[l] * sizeof *a->nodes[l]);
  }
}

static void assert_same_grid(const vxm_sparse *sparse, const vxm_grid *grid) {
  vxm_grid *back;
  assert_int_equal(vxm_sparse_to_grid(&back, sparse, NULL), VXM_OK);
  assert_memory_equal(back->words, grid->words, grid->word_count * sizeof *grid->words);
  vxm_grid_destroy(back);
  assert_true(vxm_sparse_count(sparse) == vxm_grid_count(grid));
  assert_true(vxm_sparse_hash(sparse) == vxm_grid_hash(grid));
}

static void test_same_as_grid(void **state) {
  (void)state;
  vxm_rng rng = {61};
  for (int round = 0; round < 60; round++) {
    vxm_grid *grid = random_grid(contexts[round % 3], &rng, round % KINDS);
    const int64_t *n = grid->space.dims;
    vxm_sparse *sparse = octree_of(grid);
    assert_same_grid(sparse, grid);
    for (int64_t k = -1; k <= n[2]; k++)
      for (int64_t j = -1; j <= n[1]; j++)
        for (int64_t i = -1; i <= n[0]; i++)
          if (vxm_sparse_get(sparse, i, j, k) != vxm_grid_get(grid, i, j, k))
            fail_msg("voxel %d %d %d", (int)i, (int)j, (int)k);
    for (size_t b = 0; b < sparse->brick_count; b++)
      assert_true(sparse->bricks[b] != 0 && ~sparse->bricks[b] != 0);
    assert_true(vxm_sparse_bytes(sparse) >= 8 * (uint64_t)vxm_sparse_bricks(sparse));
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
}

/** Rows long enough for runs of full nodes of several levels. */
static void test_long_rows(void **state) {
  (void)state;
  static const int64_t dims[4][3] = {{5000, 17, 20}, {20, 5000, 17}, {17, 20, 5000}, {256, 64, 64}};
  vxm_rng rng = {62};
  for (int round = 0; round < 8; round++) {
    const int64_t *n = dims[round % 4];
    vxm_grid *grid = new_grid(contexts[round % 3], unit_space(n[0], n[1], n[2]));
    for (int box = 0; box < 3 && round < 7; box++) {
      int64_t low[3], high[3];
      for (int a = 0; a < 3; a++) {
        low[a] = (int64_t)vxm_rng_below(&rng, (uint64_t)n[a]);
        high[a] = low[a] + 1 + (int64_t)vxm_rng_below(&rng, (uint64_t)(n[a] - low[a]));
      }
      for (int64_t k = low[2]; k < high[2]; k++)
        for (int64_t j = low[1]; j < high[1]; j++)
          vxm_row_set_span(vxm_grid_row(grid, j, k), low[0], high[0]);
    }
    if (round == 7) /* all of 256 x 64 x 64 is four full nodes */
      fill_random(grid, &rng, 5);
    vxm_sparse *sparse = octree_of(grid);
    assert_same_grid(sparse, grid);
    if (round == 7)
      assert_int_equal(sparse->brick_count, 0);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
}

/** Long runs of full nodes side by side that begin and end at any node. */
static void test_ragged_runs(void **state) {
  (void)state;
  vxm_rng rng = {68};
  for (int round = 0; round < 12; round++) {
    vxm_grid *grid = new_grid(contexts[round % 3], unit_space(round % 2 ? 2000 : 1024, 64, 128));
    for (int64_t k = 0; k < 128; k += 16)
      for (int64_t j = 0; j < 64; j += 16) {
        int64_t begin = 16 * (int64_t)vxm_rng_below(&rng, round % 3 ? 3 : 20);
        int64_t end = grid->space.dims[0] - 16 * (int64_t)vxm_rng_below(&rng, round % 3 ? 3 : 20);
        for (int64_t row = 0; row < 256; row++)
          vxm_row_set_span(vxm_grid_row(grid, j + row % 16, k + row / 16), begin, end);
      }
    vxm_sparse *sparse = octree_of(grid);
    assert_same_grid(sparse, grid);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
}

static void check_window(const vxm_sparse *sparse, const vxm_grid *grid, vxm_layout layout, vxm_rng *rng) {
  int64_t slices = grid->space.dims[layout.slow];
  int64_t begin = (int64_t)vxm_rng_below(rng, (uint64_t)slices);
  int64_t end = begin + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(slices - begin));
  vxm_window window = vxm_window_of(&grid->space, layout, begin, end);
  size_t words = window.slice_words, gap = vxm_rng_below(rng, 3);
  window.slice_words += gap;
  window.words = malloc((size_t)(end - begin) * window.slice_words * sizeof *window.words);
  assert_non_null(window.words);
  memset(window.words, 0xa5, (size_t)(end - begin) * window.slice_words * sizeof *window.words);
  vxm_octree_fill(sparse, &window);
  for (int64_t slow = begin; slow < end; slow++) {
    for (int64_t middle = 0; middle < window.middle_dim; middle++) {
      const uint64_t *row = vxm_window_row(&window, middle, slow);
      for (int64_t fast = 0; fast < 64 * (int64_t)window.row_words; fast++) {
        int64_t p[3];
        p[layout.fast] = fast;
        p[layout.middle] = middle;
        p[layout.slow] = slow;
        if ((row[fast / 64] >> (fast % 64) & 1) != vxm_grid_get(grid, p[0], p[1], p[2]))
          fail_msg("layout %d%d%d", layout.fast, layout.middle, layout.slow);
      }
    }
    for (size_t w = words; w < window.slice_words; w++) /* gaps are left alone */
      assert_true(vxm_window_row(&window, 0, slow)[w] == UINT64_C(0xa5a5a5a5a5a5a5a5));
  }
  free(window.words);
}

static void test_windows(void **state) {
  (void)state;
  vxm_rng rng = {63};
  for (int round = 0; round < 24; round++) {
    vxm_grid *grid = random_grid(contexts[round % 3], &rng, round % KINDS);
    vxm_sparse *sparse = octree_of(grid);
    for (int l = 0; l < 6; l++)
      check_window(sparse, grid, layouts[l], &rng);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
}

static uint64_t apply(int op, uint64_t a, uint64_t b) {
  return op == VXM_SET_UNION          ? a | b
         : op == VXM_SET_INTERSECTION ? a & b
         : op == VXM_SET_DIFFERENCE   ? a & ~b
         : op == VXM_SET_COMPLEMENT   ? ~a
                                      : a ^ b;
}

static void check_set_operations(const vxm_grid *a, const vxm_grid *b) {
  vxm_grid *c = new_grid(contexts[0], a->space);
  vxm_sparse *p = octree_of(a), *q = octree_of(b), *made;
  for (int op = VXM_SET_UNION; op <= VXM_SET_COMPLEMENT; op++) {
    for (size_t w = 0; w < c->word_count; w++) {
      bool last = w % c->row_words == c->row_words - 1;
      c->words[w] = apply(op, a->words[w], b->words[w]) & (last ? vxm_grid_tail_mask(c) : ~UINT64_C(0));
    }
    const vxm_sparse *second = op == VXM_SET_COMPLEMENT ? NULL : q;
    assert_int_equal(vxm_sparse_combine(&made, p, second, (vxm_set_operation)op, NULL), VXM_OK);
    assert_same_grid(made, c);
    vxm_sparse *expected = octree_of(c);
    assert_same_octree(made, expected);
    vxm_sparse_destroy(expected);
    vxm_sparse_destroy(made);
  }
  vxm_sparse_destroy(p);
  vxm_sparse_destroy(q);
  vxm_grid_destroy(c);
}

static void test_set_operations(void **state) {
  (void)state;
  vxm_rng rng = {64};
  for (int round = 0; round < 72; round++) {
    vxm_grid *a = random_grid(contexts[round % 3], &rng, round % KINDS);
    vxm_grid *b = new_grid(contexts[0], a->space);
    fill_random(b, &rng, round / KINDS % KINDS);
    check_set_operations(a, b);
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
  }
}

/** Octrees that are large next to what changes: most of them is copied in long runs, by all threads. */
static void test_few_changes(void **state) {
  (void)state;
  vxm_rng rng = {69};
  for (int round = 0; round < 6; round++) {
    vxm_grid *a = new_grid(contexts[round % 3], unit_space(256, 250, 180));
    vxm_grid *b = new_grid(contexts[0], a->space);
    fill_random(a, &rng, round < 3 ? 1 : 2);
    for (int cube = 0; cube < 5; cube++) { /* nodes that are empty or full, between the others */
      const int64_t *n = a->space.dims;
      int64_t at[3], side = 16 << vxm_rng_below(&rng, 3);
      for (int d = 0; d < 3; d++)
        at[d] = (int64_t)vxm_rng_below(&rng, (uint64_t)(n[d] / side)) * side;
      for (int64_t row = 0; row < side * side; row++)
        for (int64_t i = 0; i < side; i++)
          vxm_grid_set(a, at[0] + i, at[1] + row % side, at[2] + row / side, cube % 2);
      for (int few = 0; few < 4; few++)
        vxm_grid_set(b, (int64_t)vxm_rng_below(&rng, (uint64_t)n[0]),
                     (int64_t)vxm_rng_below(&rng, (uint64_t)n[1]),
                     (int64_t)vxm_rng_below(&rng, (uint64_t)n[2]), true);
    }
    check_set_operations(a, b);
    check_set_operations(b, a);
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
  }
}

static void test_wrong_arguments(void **state) {
  (void)state;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *a = new_grid(contexts[0], unit_space(4, 5, 6)), *b = new_grid(contexts[0], unit_space(4, 5, 7));
  vxm_sparse *p = octree_of(a), *q = octree_of(b), *made = p;
  assert_int_equal(vxm_sparse_combine(&made, p, q, VXM_SET_UNION, &error), VXM_ERROR_ARGUMENT);
  assert_null(made);
  assert_string_equal(error.text, "combine: sets of 4 x 5 x 6 and 4 x 5 x 7 voxels cannot be combined");
  assert_int_equal(vxm_sparse_combine(&made, p, NULL, VXM_SET_UNION, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sparse_combine(&made, p, p, (vxm_set_operation)9, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sparse_from_grid(&made, NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sparse_write_coords(p, "x.txt", NULL), VXM_ERROR_ARGUMENT);
  vxm_sparse_destroy(NULL);
  vxm_sparse_destroy(p);
  vxm_sparse_destroy(q);
  vxm_grid_destroy(a);
  vxm_grid_destroy(b);
}

/* ---- Pieces ---- */

typedef struct tally {
  vxm_grid *grid;
  uint64_t last; /* Morton number of the piece before, and one */
} tally;

static uint64_t morton(const int64_t at[3]) {
  uint64_t number = 0;
  for (int b = 0; b < 20; b++)
    for (int a = 0; a < 3; a++)
      number |= (uint64_t)(at[a] >> b & 1) << (3 * b + a);
  return number;
}

static void add_piece(const vxm_sparse_piece *piece, void *payload) {
  tally *t = payload;
  assert_true(morton(piece->position) + 1 > t->last);
  t->last = morton(piece->position) + 1;
  assert_true(piece->side == 4 || piece->bits == ~UINT64_C(0));
  for (int64_t z = 0; z < piece->side; z++)
    for (int64_t y = 0; y < piece->side; y++)
      for (int64_t x = 0; x < piece->side; x++)
        if (piece->side > 4 || (piece->bits >> (16 * z + 4 * y + x) & 1)) {
          int64_t i = piece->position[0] + x, j = piece->position[1] + y, k = piece->position[2] + z;
          assert_false(vxm_grid_get(t->grid, i, j, k));
          vxm_grid_set(t->grid, i, j, k, true);
        }
}

static void test_pieces(void **state) {
  (void)state;
  vxm_rng rng = {65};
  for (int round = 0; round < 24; round++) {
    vxm_grid *grid = random_grid(contexts[round % 3], &rng, round % KINDS);
    vxm_sparse *sparse = octree_of(grid);
    tally t = {new_grid(contexts[0], grid->space), 0};
    vxm_sparse_visit(sparse, add_piece, &t);
    assert_memory_equal(t.grid->words, grid->words, grid->word_count * sizeof *grid->words);
    vxm_grid_destroy(t.grid);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
}

/* ---- Files ---- */

static unsigned char *contents(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  unsigned char *bytes = malloc(1 << 24);
  assert_non_null(bytes);
  *size = fread(bytes, 1, 1 << 24, file);
  fclose(file);
  unlink(path);
  return bytes;
}

static void assert_same_files(const char *a, const char *b) {
  size_t m, n;
  unsigned char *p = contents(a, &m), *q = contents(b, &n);
  assert_int_equal(m, n);
  assert_memory_equal(p, q, n);
  free(p);
  free(q);
}

static void check_coords(const vxm_grid *grid, const char *path) {
  size_t size, at = 0;
  unsigned char *bytes = contents(path, &size);
  char shape[64];
  snprintf(shape, sizeof shape, "{'descr': '<i4', 'fortran_order': False, 'shape': (%lld, 3), }",
           (long long)vxm_grid_count(grid));
  assert_memory_equal(bytes + 10, shape, strlen(shape));
  at = 10 + bytes[8] + 256u * bytes[9];
  assert_int_equal(at % 64, 0);
  const int64_t *n = grid->space.dims;
  for (int64_t i = 0; i < n[0]; i++)
    for (int64_t j = 0; j < n[1]; j++)
      for (int64_t k = 0; k < n[2]; k++)
        if (vxm_grid_get(grid, i, j, k)) {
          int32_t row[3];
          assert_true(at + 12 <= size);
          for (int a = 0; a < 3; a++)
            row[a] = (int32_t)vxm_load_u32(bytes + at + 4 * a, vxm_must_swap(false));
          assert_true(row[0] == i && row[1] == j && row[2] == k);
          at += 12;
        }
  assert_int_equal(at, size);
  free(bytes);
}

static void test_files(void **state) {
  (void)state;
  static const char *const formats[] = {"binvox", "npy", "raw", "rle"};
  char folder[64], a[128], b[128];
  make_folder(folder);
  vxm_rng rng = {66};
  for (int round = 0; round < 18; round++) {
    vxm_grid *grid = random_grid(contexts[round % 3], &rng, round % KINDS);
    vxm_sparse *sparse = octree_of(grid);
    for (int f = 0; f < 4; f++) {
      snprintf(a, sizeof a, "%s/a.%s", folder, formats[f]);
      snprintf(b, sizeof b, "%s/b.%s", folder, formats[f]);
      assert_int_equal(vxm_grid_write(grid, a, NULL, NULL), VXM_OK);
      assert_int_equal(vxm_sparse_write(sparse, b, NULL, NULL), VXM_OK);
      assert_same_files(a, b);
    }
    snprintf(a, sizeof a, "%s/c.npy", folder);
    assert_int_equal(vxm_sparse_write_coords(sparse, a, NULL), VXM_OK);
    check_coords(grid, a);
    assert_int_equal(vxm_grid_write_coords(grid, a, NULL), VXM_OK);
    check_coords(grid, a);
    empty_folder(folder);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
  remove_folder(folder);
}

static void test_memory_limit(void **state) {
  (void)state;
  int failures = 0, successes = 0;
  for (uint64_t limit = 1 << 16; limit < 1 << 24; limit += limit / 3) {
    vxm_context *context = context_with(2, limit, NULL, NULL);
    vxm_rng rng = {67};
    vxm_grid *grid;
    vxm_sparse *a = NULL, *b = NULL;
    vxm_space space = unit_space(100, 60, 70);
    if (vxm_grid_create(&grid, context, &space, NULL) == VXM_OK) {
      fill_random(grid, &rng, 3);
      vxm_error error = VXM_ERROR_INIT;
      vxm_status status = vxm_sparse_from_grid(&a, grid, &error);
      if (status == VXM_OK)
        status = vxm_sparse_combine(&b, a, NULL, VXM_SET_COMPLEMENT, &error);
      assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
      assert_int_equal(error.code, status);
      assert_int_equal(b != NULL, status == VXM_OK);
      failures += status != VXM_OK;
      successes += status == VXM_OK;
      vxm_sparse_destroy(a);
      vxm_sparse_destroy(b);
      vxm_grid_destroy(grid);
    }
    vxm_context_destroy(context);
  }
  assert_true(failures > 2 && successes > 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_same_as_grid),   cmocka_unit_test(test_long_rows),
      cmocka_unit_test(test_ragged_runs),    cmocka_unit_test(test_windows),
      cmocka_unit_test(test_set_operations), cmocka_unit_test(test_wrong_arguments),
      cmocka_unit_test(test_pieces),         cmocka_unit_test(test_files),
      cmocka_unit_test(test_memory_limit),   cmocka_unit_test(test_few_changes),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
