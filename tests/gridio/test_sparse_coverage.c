/* SPDX-License-Identifier: BSD-3-Clause */
/** Coverage at every level, of octrees and their files, against counting voxel by voxel in the dense grid; of
 * damaged files too. */
#include "grids.h"

#include "base/endian.h"
#include "gridio/formats/octree/octree_file.h"

enum { CUBES_MOST = 40000 };

/** Dense boxes and single voxels, over several tiles. */
static vxm_grid *random_grid(vxm_context *context, vxm_rng *rng, int round) {
  static const int64_t dims[][3] = {{1, 1, 1},     {5, 16, 17},   {64, 65, 3},   {256, 256, 20},
                                    {257, 70, 31}, {600, 300, 9}, {20, 17, 700}, {512, 30, 270}};
  const int64_t *n = dims[round % 8];
  vxm_space space = {{n[0], n[1], n[2]}, {-1.5, 0.1, 2e-7}, {0.25, 0.5, 1.0 / 3}};
  vxm_grid *grid = new_grid(context, space);
  for (int box = 0; box < 1 + round % 3; box++) {
    int64_t low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = (int64_t)vxm_rng_below(rng, (uint64_t)n[a]);
      high[a] = low[a] + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(n[a] - low[a]));
    }
    if (round % 8 == 7 && box == 0) /* full tiles */
      for (int a = 0; a < 3; a++)
        low[a] = 0, high[a] = n[a];
    for (int64_t k = low[2]; k < high[2]; k++)
      for (int64_t j = low[1]; j < high[1]; j++)
        vxm_row_set_span(vxm_grid_row(grid, j, k), low[0], high[0]);
  }
  for (int voxel = 0; voxel < 300; voxel++) {
    int64_t i = (int64_t)vxm_rng_below(rng, (uint64_t)n[0]), j = (int64_t)vxm_rng_below(rng, (uint64_t)n[1]);
    vxm_grid_row(grid, j, (int64_t)vxm_rng_below(rng, (uint64_t)n[2]))[i / 64] ^= UINT64_C(1) << i % 64;
  }
  return grid;
}

static uint64_t count_in(const vxm_grid *grid, const int64_t cube[3], int64_t side) {
  uint64_t count = 0;
  int64_t end[3];
  for (int a = 0; a < 3; a++)
    end[a] = vxm_min((cube[a] + 1) * side, grid->space.dims[a]);
  for (int64_t k = cube[2] * side; k < end[2]; k++)
    for (int64_t j = cube[1] * side; j < end[1]; j++)
      for (int64_t i = cube[0] * side; i < end[0]; i++)
        count += vxm_grid_get(grid, i, j, k);
  return count;
}

/** @return what a number of the field should be, as an integer where it is one */
static double expected(uint64_t count, uint64_t most, vxm_scalar scalar) {
  if (scalar == VXM_UINT8)
    return (double)((255 * count * 2 + most) / (2 * most));
  if (scalar == VXM_FLOAT32)
    return (double)(float)((double)count / (double)most);
  return scalar == VXM_FLOAT64 ? (double)count / (double)most : (double)count;
}

static double number_at(const vxm_field *field, size_t at) {
  const void *values = vxm_field_values(field);
  switch (vxm_field_scalar(field)) {
  case VXM_UINT8:
    return ((const uint8_t *)values)[at];
  case VXM_FLOAT32:
    return (double)((const float *)values)[at];
  case VXM_FLOAT64:
    return ((const double *)values)[at];
  default:
    return (double)((const uint64_t *)values)[at];
  }
}

static void assert_coverage(const vxm_field *field, const vxm_grid *grid, int64_t side,
                            const int64_t begin[3], vxm_scalar scalar) {
  const vxm_space *space = vxm_field_space(field);
  uint64_t most = (uint64_t)(side * side * side);
  size_t at = 0;
  assert_int_equal(vxm_field_kind_of(field), scalar == VXM_UINT64 ? VXM_FIELD_NUMBERS : VXM_FIELD_COVERAGE);
  for (int a = 0; a < 3; a++) {
    double size = grid->space.voxel_size[a] * (double)side;
    assert_true(space->voxel_size[a] == size);
    assert_true(space->origin[a] == grid->space.origin[a] + (double)begin[a] * size);
  }
  for (int64_t x = 0; x < space->dims[0]; x++)
    for (int64_t y = 0; y < space->dims[1]; y++)
      for (int64_t z = 0; z < space->dims[2]; z++, at++) {
        const int64_t cube[3] = {begin[0] + x, begin[1] + y, begin[2] + z};
        double wanted = expected(count_in(grid, cube, side), most, scalar), found = number_at(field, at);
        if (wanted != found)
          fail_msg("cube %d %d %d of %d voxels: %.17g, not %.17g", (int)cube[0], (int)cube[1], (int)cube[2],
                   (int)side, found, wanted);
      }
}

static void check_side(const vxm_sparse *sparse, const vxm_sparse_file *file, const vxm_grid *grid,
                       int64_t side, vxm_rng *rng) {
  static const vxm_scalar scalars[] = {VXM_FLOAT32, VXM_FLOAT64, VXM_UINT8, VXM_UINT64};
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = (int)side;
  options.scalar = scalars[vxm_rng_below(rng, 4)];
  int64_t begin[3], end[3], cubes = 1;
  for (int a = 0; a < 3; a++) {
    end[a] = (grid->space.dims[a] + side - 1) / side;
    cubes *= end[a];
    begin[a] = 0;
  }
  bool is_whole = cubes < CUBES_MOST;
  for (int a = 0; a < 3 && !is_whole; a++) {
    begin[a] = (int64_t)vxm_rng_below(rng, (uint64_t)end[a]);
    end[a] = vxm_min(begin[a] + 1 + (int64_t)vxm_rng_below(rng, 40), end[a]);
  }
  vxm_field *field;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sparse_coverage(&field, sparse, &options, is_whole ? NULL : begin, is_whole ? NULL : end, &error) !=
      VXM_OK)
    fail_msg("%s", error.text);
  assert_coverage(field, grid, side, begin, options.scalar);
  vxm_field_destroy(field);
  if (vxm_sparse_file_coverage(&field, file, &options, begin, end, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_coverage(field, grid, side, begin, options.scalar);
  vxm_field_destroy(field);
  end[1]++;
  if (is_whole)
    assert_int_equal(vxm_sparse_coverage(&field, sparse, &options, begin, end, NULL), VXM_ERROR_ARGUMENT);
}

static void test_same_as_counting(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_rng rng = {71};
  for (int round = 0; round < 16; round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_grid *grid = random_grid(context, &rng, round);
    vxm_sparse *sparse;
    vxm_sparse_file *file;
    assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_write(sparse, path, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_file_open(&file, context, path, NULL), VXM_OK);
    for (int64_t side = 1; side <= 2048; side *= 2)
      check_side(sparse, file, grid, side, &rng);
    vxm_sparse_file_close(file);
    vxm_sparse_destroy(sparse);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

static void test_options(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {72};
  vxm_grid *grid = random_grid(context, &rng, 1);
  vxm_sparse *sparse;
  vxm_field *field;
  assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
  static const int sides[] = {0, -4, 3, 12, 1 << 21, INT32_MIN};
  for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
    vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
    options.subdivision = sides[s];
    assert_int_equal(vxm_sparse_coverage(&field, sparse, &options, NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
    assert_null(field);
  }
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.scalar = VXM_INT16;
  assert_int_equal(vxm_sparse_coverage(&field, sparse, &options, NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
  options = (vxm_coverage_options)VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = 1 << 20;
  options.scalar = VXM_UINT64;
  assert_int_equal(vxm_sparse_coverage(&field, sparse, &options, NULL, NULL, NULL), VXM_OK);
  assert_true(number_at(field, 0) == (double)vxm_grid_count(grid));
  vxm_field_destroy(field);
  vxm_sparse_destroy(sparse);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

/** From a block of exactly the size, so that a sanitizer sees every step beyond it. */
static void count_bytes(vxm_context *context, const unsigned char *data, size_t size, int side) {
  unsigned char *copy = malloc(size);
  assert_non_null(copy);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = "a.octree", .context = context};
  vxm_sparse_file *file;
  vxm_field *field;
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = side;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_octree_file_open(&file, &input, &error) == VXM_OK) {
    if (vxm_sparse_file_coverage(&field, file, &options, NULL, NULL, &error) == VXM_OK) {
      vxm_field_range range = VXM_FIELD_RANGE_INIT;
      assert_int_equal(vxm_field_measure(&range, field, NULL), VXM_OK);
      assert_true(range.min >= 0 && range.max <= 1);
    }
    vxm_field_destroy(field);
    vxm_sparse_file_close(file);
  }
  free(copy);
}

static void test_damage(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_context *context = context_with(1, UINT64_C(1) << 24, NULL, NULL);
  vxm_rng rng = {73};
  for (int kind = 3; kind < 8; kind++) {
    vxm_grid *grid = random_grid(context, &rng, kind);
    assert_int_equal(vxm_grid_write(grid, path, NULL, NULL), VXM_OK);
    size_t size;
    unsigned char *data = load_file(path, &size);
    size_t index = (size_t)vxm_load_le64(data + 96);
    for (int round = 0; round < 300; round++) {
      unsigned char before[3];
      size_t at[3];
      for (int c = 0; c < 3; c++) { /* header, index, anywhere */
        at[c] = c == 0   ? vxm_rng_below(&rng, 112)
                : c == 1 ? index + vxm_rng_below(&rng, size - index)
                         : vxm_rng_below(&rng, size);
        before[c] = data[at[c]];
        if (round % 3 == c || round % 7 == 0)
          data[at[c]] = (unsigned char)(data[at[c]] ^ 1U << vxm_rng_below(&rng, 8));
      }
      count_bytes(context, data, size, round % 2 ? 256 : 32);
      for (int c = 2; c >= 0; c--)
        data[at[c]] = before[c];
    }
    free(data);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Where a damaged file is, is told the same by any number of threads. */
static void test_damage_told(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  char told[2][512];
  for (int t = 0; t < 2; t++) {
    vxm_context *context = context_with(1 + 3 * t, 0, NULL, NULL);
    vxm_rng rng = {75};
    vxm_grid *grid = random_grid(context, &rng, 13); /* 600 x 300 x 9: six rows of tiles */
    assert_int_equal(vxm_grid_write(grid, path, NULL, NULL), VXM_OK);
    size_t size;
    unsigned char *data = load_file(path, &size);
    for (size_t at = 112 + 8; at < vxm_load_le64(data + 96); at += 640)
      data[at] ^= 255;
    vxm_input input = {.data = data, .size = size, .name = "a.octree", .context = context};
    vxm_sparse_file *file;
    vxm_field *field;
    vxm_error error = VXM_ERROR_INIT;
    vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
    options.subdivision = 16;
    assert_int_equal(vxm_octree_file_open(&file, &input, &error), VXM_OK);
    assert_int_equal(vxm_sparse_file_coverage(&field, file, &options, NULL, NULL, &error), VXM_ERROR_FORMAT);
    assert_null(field);
    snprintf(told[t], sizeof told[t], "%s", error.text);
    vxm_sparse_file_close(file);
    free(data);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  assert_string_equal(told[0], told[1]);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_same_as_counting),
      cmocka_unit_test(test_options),
      cmocka_unit_test(test_damage),
      cmocka_unit_test(test_damage_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
