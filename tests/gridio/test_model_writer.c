/* SPDX-License-Identifier: BSD-3-Clause */
/** Models voxelized straight into files: the bytes of the whole grid, in the memory that is left. */
#include "grids.h"

#include "../voxel/engine.h"

#include "gridio/gridio.h"

static const char *const formats[] = {"binvox", "npy",    "raw", "rle", "nrrd",
                                      "nii",    "nii.gz", "vti", "vtk", "tif"};

enum { FORMATS = sizeof formats / sizeof formats[0] };

static void assert_same_file(const char *a, const char *b) {
  size_t sizes[2];
  unsigned char *data[2] = {load_file(a, &sizes[0]), load_file(b, &sizes[1])};
  assert_int_equal(sizes[0], sizes[1]);
  assert_memory_equal(data[0], data[1], sizes[0]);
  free(data[0]);
  free(data[1]);
}

static void assert_same_warnings(const vxm_model *model, const vxm_grid *grid) {
  assert_int_equal(vxm_model_warning_count(model), vxm_grid_warning_count(grid));
  for (int64_t w = 0; w < vxm_grid_warning_count(grid); w++)
    assert_string_equal(vxm_model_warning(model, w), vxm_grid_warning(grid, w));
}

typedef struct wanted {
  const vxm_grid *grid;
  const vxm_voxelize_report *report;
  const char *file, *folder;
  bool told; /**< the estimate holds; the winding number, where it is asked, takes memory of its own */
} wanted;

/** Writes with so much memory left: the same file within it, or none. Returns the windows, 0 if refused. */
static int64_t write_within(vxm_context *own, vxm_model *model, const char *path, size_t left,
                            const wanted *want) {
  const vxm_space *space = &want->grid->space;
  vxm_estimate estimate = VXM_ESTIMATE_INIT;
  vxm_error error = VXM_ERROR_INIT;
  leave_memory(own, left);
  size_t held = memory_used(own);
  atomic_store(&own->peak, held);
  int files = count_files(want->folder);
  vxm_status told = vxm_model_estimate(&estimate, model, space, path, NULL, &error);
  assert_int_equal(count_files(want->folder), files);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_status status = vxm_model_write(&report, model, space, path, NULL, &error);
  assert_true(status == told || (!want->told && told == VXM_OK));
  leave_memory(own, SIZE_MAX);
  uint64_t peak = vxm_context_peak_bytes(own);
  assert_true(peak <= held + left || left == SIZE_MAX);
  if (status != VXM_OK) {
    assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
    assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
    assert_int_equal(count_files(want->folder), files);
    assert_true(estimate.memory_bytes == 0 || !want->told);
    assert_int_equal(report.voxels, 0);
    return 0;
  }
  assert_true(estimate.memory_bytes <= left);
  assert_int_equal(estimate.grid_bytes, vxm_space_bytes(space));
  assert_in_range(estimate.passes, 1, 1 << 20);
  if (want->told && peak > held + estimate.memory_bytes)
    fail_msg("%s took %llu bytes, and %llu were told", path, (unsigned long long)(peak - held),
             (unsigned long long)estimate.memory_bytes);
  assert_same_file(want->file, path);
  assert_equal_reports(&report, want->report);
  assert_same_warnings(model, want->grid);
  remove(path);
  return estimate.passes;
}

/** With less and less memory, down to too little. Returns the most windows. */
static int64_t write_in_less_and_less(const vxm_soup *soup, const vxm_voxelize_options *options,
                                      const char *path, const wanted *want) {
  vxm_context *own = soup->context;
  /* Fresh models: what one has kept need not be taken again. */
  vxm_model *model = engine_model(soup, options);
  vxm_estimate estimate = VXM_ESTIMATE_INIT;
  assert_int_equal(vxm_model_estimate(&estimate, model, &want->grid->space, path, NULL, NULL), VXM_OK);
  int64_t windows = write_within(own, model, path, SIZE_MAX, want), most = windows;
  assert_int_equal(windows, 1);
  vxm_model_destroy(model);
  for (size_t left = (size_t)estimate.memory_bytes * 9 / 8; windows > 0; left -= left / 5) {
    model = engine_model(soup, options);
    windows = write_within(own, model, path, left, want);
    if (windows > 0 && left % 3 == 0) /* once more with the same model */
      assert_int_not_equal(write_within(own, model, path, left, want), 0);
    vxm_model_destroy(model);
    most = vxm_max(most, windows);
  }
  return most;
}

/** Every other format, in turn: all of them in two calls. */
static void check_formats(const vxm_voxelize_options *options, int kind, const vxm_space *space, int threads,
                          int64_t windows, bool told) {
  static int turn;
  char folder[64], whole[100], path[100];
  make_folder(folder);
  vxm_soup *soup = random_soup(context, 7, kind, space);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid = engine_solid(soup, space, options, &report);
  for (int f = turn++ % 2; f < FORMATS; f += 2) {
    snprintf(whole, sizeof whole, "%s/whole.%s", folder, formats[f]);
    snprintf(path, sizeof path, "%s/stream.%s", folder, formats[f]);
    assert_int_equal(vxm_gridio_write(grid, whole, NULL, NULL), VXM_OK);
    vxm_context *own = context_with(threads, 0, NULL, NULL);
    vxm_soup *own_soup = random_soup(own, 7, kind, space);
    wanted want = {grid, &report, whole, folder, told};
    int64_t most = write_in_less_and_less(own_soup, options, path, &want);
    assert_true(most >= windows);
    empty_folder(folder);
    vxm_soup_destroy(own_soup);
    vxm_context_destroy(own);
  }
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
  remove_folder(folder);
}

static void test_files_of_one_voter(void **state) {
  (void)state;
  vxm_space space = engine_space(190, 200, 210);
  for (int method = VXM_METHOD_X; method <= VXM_METHOD_Z; method++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = (vxm_method)method;
    check_formats(&options, method % 2 ? 4 : 5, &space, 1 + method % 3, 2, true);
  }
}

static void test_files_of_the_default(void **state) {
  (void)state;
  static const int kinds[] = {0, 2, 4, 5};
  vxm_space space = engine_space(200, 190, 210);
  for (int k = 0; k < 4; k++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    /* What stays open may ask the winding number, which takes more than these grids do. */
    check_formats(&options, kinds[k], &space, 1 + k % 3, kinds[k] < 4 ? 1 : 2, true);
  }
}

static void test_files_of_votes(void **state) {
  (void)state;
  static const int kinds[] = {7, 6, 2};
  vxm_space space = engine_space(110, 120, 130);
  for (int k = 0; k < 3; k++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.vote = (vxm_vote)(VXM_VOTE_MAJORITY + k);
    check_formats(&options, kinds[k], &space, 1 + k, 2, true);
  }
}

/** Where the winding number decides, its triangles and the look that turns them count, too. */
static void test_files_of_winding_numbers(void **state) {
  (void)state;
  vxm_space space = engine_space(60, 50, 70);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  check_formats(&options, 3, &space, 1, 1, true);
  check_formats(&options, 6, &space, 2, 1, true);
  options.method = VXM_METHOD_WINDING;
  check_formats(&options, 0, &space, 1, 1, true);
}

/** Meshes of the surface, the surface, and the confidence need the whole grid. */
static void test_what_needs_the_whole_grid(void **state) {
  (void)state;
  static const char *const names[] = {"obj", "ply", "stl", "off", "rle", "binvox"};
  vxm_space space = engine_space(40, 50, 30);
  for (int n = 0; n < 6; n++)
    for (int what = 0; what < 3; what++) {
      char folder[64], whole[100], path[100];
      make_folder(folder);
      snprintf(whole, sizeof whole, "%s/whole.%s", folder, names[n]);
      snprintf(path, sizeof path, "%s/stream.%s", folder, names[n]);
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.mode = what == 1 ? VXM_MODE_BOTH : VXM_MODE_SOLID;
      options.confidence = what == 2;
      vxm_soup *soup = random_soup(context, 8, 5 + n % 3, &space);
      vxm_voxelize_report want = VXM_VOXELIZE_REPORT_INIT, report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid = engine_solid(soup, &space, &options, &want);
      assert_int_equal(vxm_gridio_write(grid, whole, NULL, NULL), VXM_OK);
      vxm_model *model = engine_model(soup, &options);
      vxm_estimate estimate = VXM_ESTIMATE_INIT;
      assert_int_equal(vxm_model_estimate(&estimate, model, &space, path, NULL, NULL), VXM_OK);
      assert_int_equal(estimate.passes, 1);
      assert_int_equal(vxm_model_write(&report, model, &space, path, NULL, NULL), VXM_OK);
      assert_same_file(whole, path);
      assert_equal_reports(&want, &report);
      assert_same_warnings(model, grid);
      vxm_model_destroy(model);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
      remove_folder(folder);
    }
}

/** Cancelled at every window, no file is left, and the model writes the next one. */
static int stop_after(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  int *left = payload;
  return *left >= 0 && (*left)-- == 0;
}

static void test_cancelled_files_are_not_left(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  int left = -1;
  vxm_context *own = context_with(2, 0, stop_after, &left);
  vxm_space space = engine_space(120, 130, 140);
  vxm_soup *soup = random_soup(own, 9, 7, &space);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.vote = VXM_VOTE_ANY;
  vxm_grid *grid = engine_solid(soup, &space, &options, NULL);
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "whole.rle"), NULL, NULL), VXM_OK);
  vxm_model *model = engine_model(soup, &options);
  vxm_status status = VXM_ERROR_CANCELLED;
  for (int calls = 0; status != VXM_OK; calls += 1 + calls / 4) {
    left = calls;
    status = vxm_model_write(NULL, model, &space, path_in(folder, "stream.rle"), NULL, NULL);
    assert_true(status == VXM_OK || status == VXM_ERROR_CANCELLED);
    assert_int_equal(count_files(folder), status == VXM_OK ? 2 : 1);
  }
  assert_same_file(path_in(folder, "whole.rle"), path_in(folder, "stream.rle"));
  vxm_model_destroy(model);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
  vxm_context_destroy(own);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_files_of_one_voter),
      cmocka_unit_test(test_files_of_the_default),
      cmocka_unit_test(test_files_of_votes),
      cmocka_unit_test(test_files_of_winding_numbers),
      cmocka_unit_test(test_what_needs_the_whole_grid),
      cmocka_unit_test(test_cancelled_files_are_not_left),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
