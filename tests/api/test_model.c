/* SPDX-License-Identifier: BSD-3-Clause */
/** Spaces and models as a caller sees them: arguments, and what a refusal leaves behind. */
#include "api_support.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

static const vxm_space unit = {{8, 9, 10}, {-1, -1, -1}, {0.25, 0.25, 0.25}};

static void assert_refused(vxm_status status, const vxm_error *error) {
  assert_int_equal(status, VXM_ERROR_ARGUMENT);
  assert_int_equal(error->code, VXM_ERROR_ARGUMENT);
  assert_true(strlen(error->text) > 0);
}

static void test_space_fit(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_error error = VXM_ERROR_INIT;
  vxm_space space = unit, direct;
  assert_refused(vxm_space_fit(NULL, mesh, NULL, &error), &error);
  assert_refused(vxm_space_fit(&space, NULL, NULL, &error), &error);
  assert_int_equal(space.dims[0], 0);
  vxm_space_options options = VXM_SPACE_OPTIONS_INIT;
  for (size_t size = 0; size < sizeof(size_t); size++) {
    options.size = size;
    space = unit;
    vxm_status status = vxm_space_fit(&space, mesh, &options, &error);
    assert_int_equal(status, VXM_ERROR_ARGUMENT);
    assert_int_equal(space.dims[0], 0);
  }
  options.size = sizeof options;
  options.fit = (vxm_fit)9;
  assert_refused(vxm_space_fit(&space, mesh, &options, &error), &error);
  options.fit = VXM_FIT_CUBE;
  options.resolution[1] = 5;
  assert_refused(vxm_space_fit(&space, mesh, &options, &error), &error);
  options.resolution[1] = 0;
  options.resolution[0] = (INT64_C(1) << 20) + 1;
  assert_int_equal(vxm_space_fit(&space, mesh, &options, NULL), VXM_ERROR_RANGE);
  /* Without options as with the defaults; and `like` is taken as it is. */
  assert_int_equal(vxm_space_fit(&space, mesh, NULL, NULL), VXM_OK);
  vxm_space_options defaults = VXM_SPACE_OPTIONS_INIT;
  assert_int_equal(vxm_space_fit(&direct, mesh, &defaults, NULL), VXM_OK);
  assert_memory_equal(&space, &direct, sizeof space);
  defaults.like = &unit;
  assert_int_equal(vxm_space_fit(&space, mesh, &defaults, NULL), VXM_OK);
  assert_memory_equal(&space, &unit, sizeof space);
  vxm_mesh_destroy(mesh);
}

static void test_model_create(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *made;
  assert_refused(vxm_model_create(NULL, mesh, NULL, &error), &error);
  made = (vxm_model *)mesh;
  assert_refused(vxm_model_create(&made, NULL, NULL, &error), &error);
  assert_null(made);
  vxm_voxelize_options good = VXM_VOXELIZE_OPTIONS_INIT, bad[6];
  for (int i = 0; i < 6; i++)
    bad[i] = good;
  bad[0].size = 2;
  bad[1].method = (vxm_method)6;
  bad[2].vote = (vxm_vote)-1;
  bad[3].mode = (vxm_mode)3;
  bad[4].cavities = (vxm_cavities)3;
  bad[5].split_mode = (vxm_split_mode)3;
  for (int i = 0; i < 6; i++) {
    made = (vxm_model *)mesh;
    assert_refused(vxm_model_create(&made, mesh, &bad[i], &error), &error);
    assert_null(made);
  }
  assert_int_equal(vxm_model_create(&made, mesh, &good, NULL), VXM_OK);
  vxm_model_destroy(made);
  assert_int_equal(vxm_model_create(&made, mesh, NULL, NULL), VXM_OK);
  vxm_model_destroy(made);
  vxm_model_destroy(NULL);
  vxm_mesh_destroy(mesh);
  vxm_mesh_arrays nothing = VXM_MESH_ARRAYS_INIT;
  assert_int_equal(vxm_mesh_create(&mesh, NULL, &nothing, NULL), VXM_OK);
  assert_int_equal(vxm_model_create(&made, mesh, NULL, &error), VXM_ERROR_EMPTY);
  assert_null(made);
  vxm_mesh_destroy(mesh);
}

static void test_model_voxelize(void **state) {
  (void)state;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  vxm_mesh *mesh = mesh_of_model(context, "cube");
  vxm_model *made;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_model_create(&made, mesh, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_grid_create(&grid, context, &unit, NULL), VXM_OK);
  vxm_voxelize_report report = {.voxels = 5};
  assert_refused(vxm_model_voxelize(NULL, &report, made, NULL, &error), &error);
  assert_int_equal(report.voxels, 0);
  report.voxels = 5;
  assert_refused(vxm_model_voxelize(grid, &report, NULL, NULL, &error), &error);
  assert_int_equal(report.voxels, 0);
  assert_refused(vxm_model_voxelize(grid, NULL, made, (double[12]){0}, &error), &error);
  assert_refused(vxm_model_voxelize(grid, NULL, made, (double[12]){NAN}, NULL), &error);
  assert_int_equal(vxm_model_voxelize(grid, NULL, made, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(grid, &report, made, NULL, NULL), VXM_OK);
  assert_int_equal(report.voxels, vxm_grid_count(grid));
  assert_string_equal(vxm_model_warning(made, -1), "");
  assert_string_equal(vxm_model_warning(made, vxm_model_warning_count(made)), "");
  /* The mesh and the context may be let go in any order once the model is gone. */
  vxm_model_destroy(made);
  vxm_context_destroy(context);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
}

static void test_model_write_and_estimate(void **state) {
  (void)state;
  static const char path[] = "test_model_written.rle";
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_model *made;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_model_create(&made, mesh, NULL, NULL), VXM_OK);
  vxm_grid_write_options unknown = VXM_GRID_WRITE_OPTIONS_INIT, npy = VXM_GRID_WRITE_OPTIONS_INIT,
                         odd = VXM_GRID_WRITE_OPTIONS_INIT;
  unknown.size = 3;
  npy.format = "npy";
  odd.format = "zip";
  vxm_estimate estimate = {.grid_bytes = 1, .memory_bytes = 2, .passes = 3};
  vxm_voxelize_report report = {.voxels = 5};
  const struct {
    const vxm_model *made;
    const vxm_space *space;
    const char *path;
    const vxm_grid_write_options *options;
  } bad[] = {{NULL, &unit, path, NULL},     {made, NULL, path, NULL},  {made, &unit, NULL, NULL},
             {made, &unit, path, &unknown}, {made, &unit, path, &odd}, {made, &unit, "no_extension", NULL}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    estimate.passes = 3;
    report.voxels = 5;
    assert_refused(
        vxm_model_estimate(&estimate, bad[i].made, bad[i].space, bad[i].path, bad[i].options, &error),
        &error);
    assert_true(estimate.grid_bytes == 0 && estimate.memory_bytes == 0 && estimate.passes == 0);
    assert_refused(
        vxm_model_write(&report, i == 0 ? NULL : made, bad[i].space, bad[i].path, bad[i].options, &error),
        &error);
    assert_int_equal(report.voxels, 0);
    assert_int_not_equal(access(path, F_OK), 0);
  }
  assert_refused(vxm_model_estimate(NULL, made, &unit, path, NULL, &error), &error);
  vxm_space spaces[4] = {unit, unit, unit, unit};
  spaces[0].dims[1] = 0;
  spaces[1].dims[2] = (INT64_C(1) << 20) + 1;
  spaces[2].voxel_size[0] = 0;
  spaces[3].origin[2] = NAN;
  for (int i = 0; i < 4; i++) {
    vxm_status told = vxm_model_estimate(&estimate, made, &spaces[i], path, NULL, NULL);
    assert_true(told == VXM_ERROR_ARGUMENT || told == VXM_ERROR_RANGE);
    assert_int_equal(vxm_model_write(NULL, made, &spaces[i], path, NULL, NULL), told);
  }
  /* The format goes before the extension; nothing is opened by an estimate. */
  assert_int_equal(vxm_model_estimate(&estimate, made, &unit, path, &npy, NULL), VXM_OK);
  assert_int_equal(estimate.passes, 1);
  assert_int_not_equal(access(path, F_OK), 0);
  assert_int_equal(vxm_model_write(&report, made, &unit, path, &npy, NULL), VXM_OK);
  char begin[6] = "";
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  assert_int_equal(fread(begin, 1, 6, file), 6);
  fclose(file);
  assert_memory_equal(begin, "\x93NUMPY", 6);
  assert_true(report.fill_ms >= 0 && report.write_ms >= 0);
  assert_int_equal(vxm_model_write(NULL, made, &unit, "no/such/folder/x.rle", NULL, &error), VXM_ERROR_IO);
  remove(path);
  remove("test_model_written.rle.json");
  vxm_model_destroy(made);
  vxm_mesh_destroy(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_space_fit),
      cmocka_unit_test(test_model_create),
      cmocka_unit_test(test_model_voxelize),
      cmocka_unit_test(test_model_write_and_estimate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
