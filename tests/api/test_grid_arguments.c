/* SPDX-License-Identifier: BSD-3-Clause */
/** Every public function with arguments that it must refuse, and what it says then: grids and voxelizing. */
#include "arguments_test.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>

static vxm_grid *small_grid(int64_t x, int64_t y, int64_t z) {
  vxm_space space = {{x, y, z}, {0, 0, 0}, {1, 1, 1}};
  vxm_grid *grid = NULL;
  assert_int_equal(vxm_grid_create(&grid, NULL, &space, NULL), VXM_OK);
  return grid;
}

/* ---- Grids ---- */

static void test_grids(void **state) {
  (void)state;
  vxm_grid *grid = junk;
  static const vxm_space good = {{4, 4, 4}, {0, 0, 0}, {1, 1, 1}};
  REFUSED(vxm_grid_create(NULL, NULL, &good, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_create(&grid, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  vxm_space bad = good;
  bad.dims[1] = 0;
  REFUSED(vxm_grid_create(&grid, NULL, &bad, &error), VXM_ERROR_ARGUMENT);
  bad = good;
  bad.voxel_size[2] = 0;
  REFUSED(vxm_grid_create(&grid, NULL, &bad, &error), VXM_ERROR_ARGUMENT);
  bad = good;
  bad.origin[0] = (double)NAN;
  REFUSED(vxm_grid_create(&grid, NULL, &bad, &error), VXM_ERROR_ARGUMENT);
  bad = good;
  bad.dims[0] = INT64_MAX;
  REFUSED(vxm_grid_create(&grid, NULL, &bad, &error), VXM_ERROR_RANGE);
  assert_null(grid);

  grid = small_grid(3, 4, 5);
  vxm_grid_set(grid, 2, 3, 4, true);
  vxm_grid_set(grid, 3, 0, 0, true);
  vxm_grid_set(grid, -1, 0, 0, true);
  vxm_grid_set(grid, 0, 4, 0, true);
  vxm_grid_set(grid, 0, 0, INT64_MAX, true);
  assert_int_equal(vxm_grid_count(grid), 1);
  assert_true(vxm_grid_get(grid, 2, 3, 4));
  assert_false(vxm_grid_get(grid, 5, 3, 4));
  assert_false(vxm_grid_get(grid, INT64_MIN, 0, 0));
  uint8_t bytes[60];
  vxm_grid_unpack(grid, bytes);
  for (int i = 0; i < 60; i++)
    assert_int_equal(bytes[i], i == 59);
  assert_int_equal(vxm_grid_row_words(grid), 1);
  assert_int_equal(vxm_grid_words(grid)[4 * 4 + 3], 4);
  uint64_t hash = vxm_grid_hash(grid);
  vxm_grid_set(grid, 2, 3, 4, false);
  assert_true(vxm_grid_hash(grid) != hash);
  assert_string_equal(vxm_grid_warning(grid, 0), "");
  vxm_grid_destroy(grid);
}

static void test_grid_files(void **state) {
  (void)state;
  vxm_grid *grid = junk;
  REFUSED(vxm_grid_read(NULL, NULL, "x.npy", &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_read(&grid, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_read(&grid, NULL, "no/such/file.npy", &error), VXM_ERROR_IO);
  REFUSED(vxm_grid_read(&grid, NULL, "/dev/null", &error), VXM_ERROR_FORMAT);
  assert_null(grid);
  vxm_mesh *mesh = junk;
  grid = small_grid(3, 4, 5);
  vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
  REFUSED(vxm_grid_write(NULL, "x.npy", NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_write(grid, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_write(grid, "x.dwg", NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_write(grid, "no/such/folder/x.npy", NULL, &error), VXM_ERROR_IO);
  options.size = 2;
  REFUSED(vxm_grid_write(grid, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_surface_mesh(NULL, grid, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_surface_mesh(&mesh, NULL, &error), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(grid);

  vxm_space flat = {{4, 4, 4}, {0, 0, 0}, {1, 1, 2}};
  assert_int_equal(vxm_grid_create(&grid, NULL, &flat, NULL), VXM_OK);
  options = (vxm_grid_write_options){.size = sizeof(vxm_grid_write_options), .format = "binvox"};
  REFUSED(vxm_grid_write(grid, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(grid);
}

static void test_pictures(void **state) {
  (void)state;
  vxm_grid *grid = small_grid(3, 4, 5);
  vxm_grid_set(grid, 1, 1, 1, true);
  vxm_picture_options options = VXM_PICTURE_OPTIONS_INIT;
  vxm_status able = vxm_grid_picture(grid, "/dev/null", &options, NULL);
  assert_true(able == VXM_OK || able == VXM_ERROR_UNAVAILABLE);
  REFUSED(vxm_grid_picture(NULL, "/dev/null", NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_picture(grid, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  if (able == VXM_OK) {
    REFUSED(vxm_grid_picture(grid, "no/such/folder/x.png", NULL, &error), VXM_ERROR_IO);
    options.size = 2;
    REFUSED(vxm_grid_picture(grid, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
    options = (vxm_picture_options)VXM_PICTURE_OPTIONS_INIT;
    options.width = -1;
    REFUSED(vxm_grid_picture(grid, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
    options = (vxm_picture_options)VXM_PICTURE_OPTIONS_INIT;
    options.up = 4;
    REFUSED(vxm_grid_picture(grid, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
    options = (vxm_picture_options)VXM_PICTURE_OPTIONS_INIT;
    options.azimuth = (double)NAN;
    REFUSED(vxm_grid_picture(grid, "/dev/null", &options, &error), VXM_ERROR_ARGUMENT);
  }
  vxm_grid_destroy(grid);
}

static void test_comparing(void **state) {
  (void)state;
  vxm_grid *a = small_grid(3, 4, 5), *b = small_grid(3, 4, 5), *c = small_grid(3, 5, 4);
  vxm_comparison found = VXM_COMPARISON_INIT;
  REFUSED(vxm_grid_compare(NULL, a, b, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_compare(&found, NULL, b, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_compare(&found, a, NULL, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_grid_compare(&found, a, c, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_compare(&found, a, b, NULL), VXM_OK);
  assert_true(found.iou == 1);
  vxm_grid_set(a, 0, 0, 0, true);
  vxm_grid_set(a, 1, 0, 0, true);
  vxm_grid_set(b, 1, 0, 0, true);
  vxm_grid_set(b, 2, 3, 4, true);
  assert_int_equal(vxm_grid_compare(&found, a, b, NULL), VXM_OK);
  assert_int_equal(found.voxels_a, 2);
  assert_int_equal(found.voxels_b, 2);
  assert_int_equal(found.both, 1);
  assert_int_equal(found.only_a, 1);
  assert_int_equal(found.only_b, 1);
  assert_true(fabs(found.iou - 1.0 / 3) < 1e-15);
  vxm_grid_destroy(a);
  vxm_grid_destroy(b);
  vxm_grid_destroy(c);
}

/* ---- Voxelization ---- */

static void test_spaces(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_space space;
  vxm_space_options options = VXM_SPACE_OPTIONS_INIT;
  REFUSED(vxm_space_fit(NULL, mesh, &options, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_space_fit(&space, NULL, &options, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_space_fit(&space, mesh, NULL, NULL), VXM_OK);
  assert_int_equal(space.dims[2], 128);
  options.size = 2;
  REFUSED(vxm_space_fit(&space, mesh, &options, &error), VXM_ERROR_ARGUMENT);
#define REFUSED_SPACE(setting, expected)                              \
  do {                                                                \
    options = (vxm_space_options)VXM_SPACE_OPTIONS_INIT;              \
    options.resolution[0] = 16;                                       \
    setting;                                                          \
    REFUSED(vxm_space_fit(&space, mesh, &options, &error), expected); \
  } while (0)
  REFUSED_SPACE(options.resolution[0] = -1, VXM_ERROR_ARGUMENT);
  REFUSED_SPACE(options.resolution[1] = 8, VXM_ERROR_ARGUMENT);
  REFUSED_SPACE(options.resolution[0] = (1 << 20) + 1, VXM_ERROR_RANGE);
  REFUSED_SPACE(options.voxel_size = 0.5, VXM_ERROR_ARGUMENT);
  REFUSED_SPACE((options.resolution[0] = 0, options.voxel_size = -1), VXM_ERROR_ARGUMENT);
  REFUSED_SPACE((options.resolution[0] = 0, options.voxel_size = (double)NAN), VXM_ERROR_ARGUMENT);
  REFUSED_SPACE((options.resolution[0] = 0, options.voxel_size = 1e-9), VXM_ERROR_RANGE);
  REFUSED_SPACE(options.pad = -1, VXM_ERROR_ARGUMENT);
  REFUSED_SPACE(options.pad = 8, VXM_ERROR_ARGUMENT);
  REFUSED_SPACE(options.fit = (vxm_fit)3, VXM_ERROR_ARGUMENT);
  REFUSED_SPACE(options.use_bounds = true, VXM_ERROR_ARGUMENT);
  vxm_mesh_destroy(mesh);
}

static void test_voxelizing(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_grid *grid = junk;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 8;
  REFUSED(vxm_voxelize(NULL, &report, mesh, &space_options, &options, &error), VXM_ERROR_ARGUMENT);
  REFUSED(vxm_voxelize(&grid, &report, NULL, &space_options, &options, &error), VXM_ERROR_ARGUMENT);
  options.size = 2;
  REFUSED(vxm_voxelize(&grid, NULL, mesh, &space_options, &options, &error), VXM_ERROR_ARGUMENT);
  assert_null(grid);
  options.size = sizeof options;
  options.method = (vxm_method)9;
  REFUSED(vxm_voxelize(&grid, NULL, mesh, &space_options, &options, &error), VXM_ERROR_ARGUMENT);
  options.method = VXM_METHOD_VOTE;
  options.vote = (vxm_vote)9;
  REFUSED(vxm_voxelize(&grid, NULL, mesh, &space_options, &options, &error), VXM_ERROR_ARGUMENT);
  options.vote = VXM_VOTE_MAJORITY;
  options.split_mode = (vxm_split_mode)9;
  REFUSED(vxm_voxelize(&grid, NULL, mesh, &space_options, &options, &error), VXM_ERROR_ARGUMENT);
  options.split_mode = VXM_SPLIT_MODE_AUTO;
  assert_int_equal(vxm_voxelize(&grid, &report, mesh, &space_options, &options, NULL), VXM_OK);
  assert_int_equal(report.voxels, 512); /* a unit cube at 8 is 8 x 8 x 8 */
  assert_int_equal(report.voxels, vxm_grid_count(grid));
  assert_true(report.hash == vxm_grid_hash(grid));
  assert_int_equal(report.parts, 1);
  assert_int_equal(report.closed_parts, 1);
  assert_int_equal(report.contested, 0);
  vxm_grid_destroy(grid);
  vxm_mesh_destroy(mesh);
}

/** No face, or no face with area. */
static void test_voxelizing_nothing(void **state) {
  (void)state;
  vxm_mesh *mesh = NULL;
  vxm_grid *grid = junk;
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, NULL), VXM_OK);
  REFUSED(vxm_voxelize(&grid, NULL, mesh, NULL, NULL, &error), VXM_ERROR_EMPTY);
  assert_null(grid);
  vxm_mesh_destroy(mesh);
  static const int64_t same[] = {1, 1, 1};
  arrays = tetrahedron();
  arrays.indices = same;
  arrays.index_count = 3;
  arrays.face_count = 1;
  assert_int_equal(vxm_mesh_create(&mesh, NULL, &arrays, NULL), VXM_OK);
  REFUSED(vxm_voxelize(&grid, NULL, mesh, NULL, NULL, &error), VXM_ERROR_EMPTY);
  vxm_mesh_destroy(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_grids),
      cmocka_unit_test(test_grid_files),
      cmocka_unit_test(test_pictures),
      cmocka_unit_test(test_comparing),
      cmocka_unit_test(test_spaces),
      cmocka_unit_test(test_voxelizing),
      cmocka_unit_test(test_voxelizing_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
