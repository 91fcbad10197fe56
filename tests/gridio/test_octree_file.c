/* SPDX-License-Identifier: BSD-3-Clause */
/** Octree files: read as they were written, whole and in windows, and damaged ones; octrees of blocks and
 * boxes. */
#include "../base/rounds.h"
#include "grids.h"

#include "base/endian.h"
#include "grid/octree_build.h"
#include "grid/octree_pieces.h"
#include "gridio/formats/octree/octree_file.h"

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

static void random_box(const int64_t dims[3], vxm_rng *rng, int64_t low[3], int64_t high[3]) {
  for (int a = 0; a < 3; a++) {
    low[a] = (int64_t)vxm_rng_below(rng, (uint64_t)dims[a]);
    high[a] = low[a] + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(dims[a] - low[a]));
  }
}

static void set_box(vxm_grid *grid, const int64_t low[3], const int64_t high[3]) {
  for (int64_t k = low[2]; k < high[2]; k++)
    for (int64_t j = low[1]; j < high[1]; j++)
      vxm_row_set_span(vxm_grid_row(grid, j, k), low[0], high[0]);
}

/** Grids of one tile, of several, and with levels above them. */
static vxm_grid *random_grid(vxm_context *context, vxm_rng *rng, int round) {
  static const int64_t dims[][3] = {{1, 1, 1},     {5, 16, 17},   {64, 65, 3},    {256, 256, 20},
                                    {257, 70, 31}, {600, 300, 9}, {20, 17, 1100}, {1030, 30, 270}};
  const int64_t *n = dims[round % 8];
  vxm_space space = {{n[0], n[1], n[2]}, {-1.5, 0.1, 2e-7}, {0.25, 0.5, 1.0 / 3}};
  vxm_grid *grid = new_grid(context, space);
  int64_t low[3], high[3];
  for (int box = 0; box < round % 4; box++) {
    random_box(n, rng, low, high);
    set_box(grid, low, high);
  }
  for (int voxel = 0; voxel < 40 * (round % 3); voxel++) {
    random_box(n, rng, low, high);
    vxm_grid_row(grid, low[1], low[2])[low[0] / 64] ^= UINT64_C(1) << low[0] % 64;
  }
  if (round % 16 == 15)
    set_box(grid, (int64_t[3]){0, 0, 0}, n);
  return grid;
}

static vxm_sparse *octree_of(const vxm_grid *grid) {
  vxm_sparse *sparse;
  assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
  return sparse;
}

static void assert_window(const vxm_grid *part, const vxm_grid *grid, const int64_t begin[3],
                          const int64_t end[3]) {
  for (int a = 0; a < 3; a++) {
    assert_int_equal(part->space.dims[a], end[a] - begin[a]);
    assert_true(part->space.origin[a] ==
                grid->space.origin[a] + (double)begin[a] * grid->space.voxel_size[a]);
  }
  for (int64_t k = begin[2]; k < end[2]; k++)
    for (int64_t j = begin[1]; j < end[1]; j++)
      for (int64_t i = begin[0]; i < end[0]; i++)
        if (vxm_grid_get(part, i - begin[0], j - begin[1], k - begin[2]) != vxm_grid_get(grid, i, j, k))
          fail_msg("voxel %d %d %d", (int)i, (int)j, (int)k);
}

static void check_windows(const vxm_sparse *sparse, const vxm_sparse_file *file, const vxm_grid *grid,
                          vxm_rng *rng) {
  for (int round = 0; round < 6; round++) {
    int64_t begin[3], end[3];
    vxm_grid *part;
    random_box(grid->space.dims, rng, begin, end);
    for (int a = 0; a < 3; a++)
      end[a] = vxm_min(end[a], begin[a] + 70);
    assert_int_equal(vxm_sparse_window(&part, sparse, begin, end, NULL), VXM_OK);
    assert_window(part, grid, begin, end);
    vxm_grid_destroy(part);
    assert_int_equal(vxm_sparse_file_window(&part, file, begin, end, NULL), VXM_OK);
    assert_window(part, grid, begin, end);
    vxm_grid_destroy(part);
    end[round % 3] = round < 3 ? begin[round % 3] : grid->space.dims[round % 3] + 1;
    assert_int_equal(vxm_sparse_file_window(&part, file, begin, end, NULL), VXM_ERROR_ARGUMENT);
    assert_null(part);
  }
}

static void test_round_trip(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {17};
  for (int round = 0; round < ROUNDS(48); round++) {
    vxm_grid *grid = random_grid(context, &rng, round), *whole;
    vxm_sparse *sparse = octree_of(grid), *back;
    vxm_sparse_file *file;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_sparse_write(sparse, path, NULL, NULL), VXM_OK);
    if (vxm_sparse_read(&back, context, path, &error) != VXM_OK)
      fail_msg("round %d: %s", round, error.text);
    assert_same_octree(sparse, back);
    assert_memory_equal(&back->space, &sparse->space, sizeof back->space);
    vxm_sparse_destroy(back);
    assert_int_equal(vxm_grid_read(&whole, context, path, NULL), VXM_OK);
    assert_memory_equal(whole->words, grid->words, grid->word_count * sizeof *grid->words);
    vxm_grid_destroy(whole);
    assert_int_equal(vxm_grid_write(grid, path, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_file_open(&file, context, path, NULL), VXM_OK);
    assert_true(vxm_sparse_file_count(file) == vxm_grid_count(grid));
    assert_memory_equal(vxm_sparse_file_space(file), &grid->space, sizeof grid->space);
    check_windows(sparse, file, grid, &rng);
    vxm_sparse_file_close(file);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Damage ---- */

/** Opens and reads from a block of exactly the size, so that a sanitizer sees every step beyond it. */
static vxm_status read_bytes(vxm_sparse **out, vxm_context *context, const unsigned char *data, size_t size,
                             vxm_error *error) {
  unsigned char *copy = malloc(size ? size : 1);
  assert_non_null(copy);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = "a.octree", .context = context};
  vxm_sparse_file *file;
  *out = NULL;
  vxm_status status = vxm_octree_file_open(&file, &input, error);
  if (status == VXM_OK)
    status = vxm_octree_file_load(out, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  vxm_sparse_file_close(file);
  free(copy);
  return status;
}

/** What was read is in the one form, whatever the bytes: as the octree of its grid. */
static void assert_sound(const vxm_sparse *sparse) {
  const int64_t *n = sparse->space.dims;
  if (n[0] > 3000 || n[1] > 3000 || n[2] > 3000 || n[0] * n[1] * n[2] > 50000000)
    return;
  vxm_grid *grid;
  assert_int_equal(vxm_sparse_to_grid(&grid, sparse, NULL), VXM_OK);
  vxm_sparse *again = octree_of(grid);
  assert_same_octree(sparse, again);
  vxm_sparse_destroy(again);
  vxm_grid_destroy(grid);
}

static void damage(vxm_context *context, const unsigned char *data, size_t size, vxm_rng *rng) {
  unsigned char *copy = malloc(size);
  assert_non_null(copy);
  for (int round = 0; round < ROUNDS(4000); round++) {
    vxm_error error = VXM_ERROR_INIT;
    vxm_sparse *sparse;
    memcpy(copy, data, size);
    for (uint64_t times = 1 + vxm_rng_below(rng, 3); times > 0; times--) {
      size_t at = vxm_rng_below(rng, round % 2 || size < 200 ? size : 200);
      uint64_t change =
          vxm_rng_below(rng, 2) ? UINT64_C(1) << vxm_rng_below(rng, 8) : vxm_rng_below(rng, 256);
      copy[at] = (unsigned char)(copy[at] ^ change);
    }
    size_t length = round % 5 == 0 ? vxm_rng_below(rng, size) : size;
    vxm_status status = read_bytes(&sparse, context, copy, length, &error);
    if (status == VXM_OK)
      assert_sound(sparse);
    else if (status == VXM_ERROR_FORMAT)
      assert_true(error.offset >= 0 && error.offset <= (int64_t)length);
    else
      assert_true(status == VXM_ERROR_RANGE || status == VXM_ERROR_MEMORY_LIMIT);
    vxm_sparse_destroy(sparse);
  }
  free(copy);
}

/** Bytes between the last tile and the index belong to nothing. */
static void check_gap(vxm_context *context, const unsigned char *data, size_t size) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_sparse *sparse;
  uint64_t index = vxm_load_le64(data + 96);
  unsigned char *copy = calloc(size + 8, 1);
  assert_non_null(copy);
  memcpy(copy, data, (size_t)index);
  memcpy(copy + index + 8, data + index, size - (size_t)index);
  vxm_store_le64(copy + 96, index + 8);
  assert_int_equal(read_bytes(&sparse, context, copy, size + 8, &error), VXM_ERROR_FORMAT);
  free(copy);
}

static void test_damage(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_context *context = context_with(1, UINT64_C(1) << 28, NULL, NULL);
  vxm_rng rng = {18};
  for (int kind = 0; kind < 8; kind++) {
    vxm_grid *grid = random_grid(context, &rng, kind + 8);
    assert_int_equal(vxm_grid_write(grid, path, NULL, NULL), VXM_OK);
    size_t size;
    unsigned char *data = load_file(path, &size);
    for (size_t length = 0; length < size; length += 1 + size / 500) {
      vxm_error error = VXM_ERROR_INIT;
      vxm_sparse *sparse;
      assert_int_equal(read_bytes(&sparse, context, data, length, &error), VXM_ERROR_FORMAT);
    }
    if (vxm_load_le64(data + 88) > 0)
      check_gap(context, data, size);
    damage(context, data, size, &rng);
    free(data);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Pieces in any order ---- */

static void test_pieces(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {19};
  for (int round = 0; round < ROUNDS(64); round++) {
    static const int64_t dims[][3] = {{7, 9, 3}, {64, 64, 64}, {65, 20, 130}, {256, 256, 256}};
    const int64_t *n = dims[round % 4];
    vxm_grid *grid = new_grid(context, unit_space(n[0], n[1], n[2]));
    vxm_octree_pieces pieces = {.context = context, .space = grid->space};
    for (int p = 0; p < 1 + round; p++) {
      int64_t low[3], high[3];
      random_box(n, &rng, low, high);
      if (p == 12) /* the whole */
        for (int a = 0; a < 3; a++)
          low[a] = 0, high[a] = n[a];
      if (p % 4 == 0) {
        for (int a = 0; a < 3; a++) /* may reach beyond the grid */
          high[a] += (int64_t)vxm_rng_below(&rng, 5), low[a] -= (int64_t)vxm_rng_below(&rng, 5);
        vxm_octree_pieces_box(&pieces, low, high);
        for (int a = 0; a < 3; a++)
          low[a] = vxm_max(low[a], 0), high[a] = vxm_min(high[a], n[a]);
        set_box(grid, low, high);
        continue;
      }
      uint64_t bits = vxm_rng_next(&rng);
      for (int a = 0; a < 3; a++)
        low[a] = low[a] / 4 * 4;
      vxm_octree_pieces_brick(&pieces, low, bits);
      for (int b = 0; b < 64; b++) {
        int64_t i = low[0] + b % 4, j = low[1] + b / 4 % 4, k = low[2] + b / 16;
        if ((bits >> b & 1) && i < n[0] && j < n[1] && k < n[2])
          vxm_grid_row(grid, j, k)[i / 64] |= UINT64_C(1) << i % 64;
      }
    }
    vxm_sparse *sparse, *expected = octree_of(grid);
    assert_int_equal(vxm_octree_pieces_end(&sparse, &pieces), VXM_OK);
    assert_same_octree(sparse, expected);
    vxm_sparse_destroy(sparse);
    vxm_sparse_destroy(expected);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_round_trip),
      cmocka_unit_test(test_damage),
      cmocka_unit_test(test_pieces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
