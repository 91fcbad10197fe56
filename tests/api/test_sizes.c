/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Structs of programs that were compiled with an older or a newer version: the library writes of a result
 * what both know and nothing behind, reads of options no more than there is, and refuses what it does not
 * know.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "api_support.h"
#include "voxmend.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROOM = 4096, MORE = 40, JUNK = 0xab };

static vxm_mesh *mesh;
static vxm_model *solid;
static vxm_grid *grid;
static vxm_field *field;
static vxm_sampler *sampler;
static vxm_error error;
static float values[8 * 8 * 8];

/* ---- Results ---- */

static vxm_status take_census(void *out) {
  return vxm_mesh_census(out, mesh, &error);
}

static vxm_status repair(void *out) {
  vxm_mesh *repaired;
  vxm_status status = vxm_mesh_repair(&repaired, out, mesh, NULL, &error);
  vxm_mesh_destroy(repaired);
  return status;
}

static vxm_status verify(void *out) {
  return vxm_mesh_verify(out, mesh, NULL, &error);
}

static vxm_status compare(void *out) {
  return vxm_grid_compare(out, grid, grid, &error);
}

static vxm_status measure(void *out) {
  return vxm_field_measure(out, field, &error);
}

static vxm_status find_readers(void *out) {
  return vxm_reading_find(out, &error);
}

static vxm_status find_engine(void *out) {
  int64_t count;
  return vxm_engines_find(out, 1, &count, &error);
}

static vxm_status voxelize(void *out) {
  return vxm_model_voxelize(grid, out, solid, NULL, &error);
}

static vxm_status estimate(void *out) {
  return vxm_model_estimate(out, solid, vxm_grid_space(grid), "x.npy", NULL, &error);
}

static vxm_status cover(void *out) {
  return vxm_model_coverage(values, out, solid, vxm_grid_space(grid), NULL, &error);
}

static vxm_status measure_distance(void *out) {
  return vxm_model_distance(values, out, solid, vxm_grid_space(grid), NULL, &error);
}

static vxm_status label(void *out) {
  return vxm_model_labels((uint16_t *)values, out, solid, vxm_grid_space(grid), NULL, &error);
}

static vxm_status pose(void *out) {
  return vxm_sampler_pose(out, sampler, &(vxm_variant){0, 0, 1}, &error);
}

/** Where the tool takes the voxels of its own solid, once. */
static vxm_status carve(void *out) {
  static const double pose[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  vxm_sparse *stock = NULL;
  vxm_carver *carver = NULL;
  vxm_status status = vxm_sparse_from_grid(&stock, grid, &error);
  if (status == VXM_OK)
    status = vxm_carver_create_sparse(&carver, stock, mesh, &error);
  if (status == VXM_OK)
    status = vxm_carver_place(out, carver, pose, &error);
  vxm_carver_destroy(carver);
  vxm_sparse_destroy(stock);
  return status;
}

/** The error of a call that fails. */
static vxm_status go_wrong(void *out) {
  return vxm_mesh_census(NULL, mesh, out) == VXM_ERROR_ARGUMENT ? VXM_OK : VXM_ERROR_ARGUMENT;
}

static const struct {
  const char *name;
  vxm_status (*call)(void *out);
  size_t known;
} results[] = {
    {"error", go_wrong, sizeof(vxm_error)},
    {"census", take_census, sizeof(vxm_census)},
    {"repair report", repair, sizeof(vxm_repair_report)},
    {"verification", verify, sizeof(vxm_verification)},
    {"comparison", compare, sizeof(vxm_comparison)},
    {"range", measure, sizeof(vxm_field_range)},
    {"readers", find_readers, sizeof(vxm_reading_info)},
    {"engine", find_engine, sizeof(vxm_engine_info)},
    {"report", voxelize, sizeof(vxm_voxelize_report)},
    {"estimate", estimate, sizeof(vxm_estimate)},
    {"coverage", cover, sizeof(vxm_coverage_report)},
    {"distance", measure_distance, sizeof(vxm_distance_report)},
    {"labels", label, sizeof(vxm_label_report)},
    {"pose", pose, sizeof(vxm_pose)},
    {"carving", carve, sizeof(vxm_carve_report)},
};

/** Of `size` bytes, with junk behind them: what is known there is as in `whole`, and the junk is still there.
 */
static void check_size(size_t r, size_t size, const unsigned char *whole) {
  unsigned char out[ROOM];
  size_t known = results[r].known, real = size == 0 ? known : size, shared = real < known ? real : known;
  memset(out, JUNK, sizeof out);
  memset(out, 0, real);
  memcpy(out, &size, sizeof size);
  assert_int_equal(results[r].call(out), VXM_OK);
  assert_memory_equal(out, &size, sizeof size);
  if (memcmp(out + sizeof size, whole + sizeof size, shared - sizeof size) != 0)
    fail_msg("%s of %zu bytes is not as one of %zu", results[r].name, size, known);
  for (size_t i = known; i < real; i++)
    assert_int_equal(out[i], 0);
  for (size_t i = real; i < sizeof out; i++)
    if (out[i] != JUNK)
      fail_msg("%s of %zu bytes is written at byte %zu", results[r].name, size, i);
}

static void test_results(void **state) {
  (void)state;
  for (size_t r = 0; r < sizeof results / sizeof *results; r++) {
    unsigned char whole[ROOM] = {0};
    size_t known = results[r].known;
    memcpy(whole, &known, sizeof known);
    assert_int_equal(results[r].call(whole), VXM_OK);
    bool told = false;
    for (size_t i = sizeof known; i < known; i++)
      told = told || whole[i] != 0;
    if (!told)
      fail_msg("nothing is told in %s", results[r].name);
    check_size(r, 0, whole);
    for (size_t size = sizeof size; size <= known; size++)
      if (size % 8 == 0 || size + 8 > known)
        check_size(r, size, whole);
    check_size(r, known + MORE, whole);
  }
}

/** Pointers behind the end of a result are not looked at. */
static void test_pointers_of_results(void **state) {
  (void)state;
  vxm_mesh *repaired;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_census after = VXM_CENSUS_INIT;
  report.before = (vxm_census *)(uintptr_t)JUNK;
  report.after = (vxm_census *)(uintptr_t)JUNK;
  report.size = offsetof(vxm_repair_report, before);
  assert_int_equal(vxm_mesh_repair(&repaired, &report, mesh, NULL, &error), VXM_OK);
  assert_ptr_equal(report.after, (void *)(uintptr_t)JUNK);
  vxm_mesh_destroy(repaired);
  report.size = sizeof report;
  report.before = NULL;
  report.after = &after;
  assert_int_equal(vxm_mesh_repair(&repaired, &report, mesh, NULL, &error), VXM_OK);
  assert_null(report.before);
  assert_ptr_equal(report.after, &after);
  assert_int_equal(after.faces, vxm_mesh_face_count(repaired));
  vxm_mesh_destroy(repaired);
  assert_int_equal(vxm_mesh_repair(&repaired, &report, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(after.faces, 0); /* nothing is left of the call before */
  assert_ptr_equal(report.after, &after);

  vxm_voxelize_report voxels = VXM_VOXELIZE_REPORT_INIT;
  vxm_coverage_report coverage = VXM_COVERAGE_REPORT_INIT;
  coverage.voxelize = (vxm_voxelize_report *)(uintptr_t)JUNK;
  coverage.size = sizeof coverage.size;
  assert_int_equal(cover(&coverage), VXM_OK);
  coverage.size = sizeof coverage;
  coverage.voxelize = &voxels;
  assert_int_equal(cover(&coverage), VXM_OK);
  assert_ptr_equal(coverage.voxelize, &voxels);
  assert_true(voxels.parts == 1 && voxels.voxels > 0);
}

/** Engines of a newer program lie farther apart. */
static void test_stride(void **state) {
  (void)state;
  struct {
    vxm_engine_info info;
    char more[MORE];
  } wide[2];
  vxm_engine_info narrow[2] = {{0}};
  int64_t count;
  memset(wide, 0, sizeof wide);
  wide[0].info.size = wide[1].info.size = sizeof wide[0];
  assert_int_equal(vxm_engines_find(narrow, 2, &count, &error), VXM_OK);
  assert_true(count >= 2);
  assert_int_equal(vxm_engines_find(&wide[0].info, 2, &count, &error), VXM_OK);
  for (int i = 0; i < 2; i++) {
    assert_true(wide[i].info.name[0] != '\0');
    assert_string_equal(wide[i].info.name, narrow[i].name);
  }
}

/* ---- Options ---- */

static void test_options(void **state) {
  (void)state;
  struct {
    vxm_repair_options options;
    char more[MORE];
  } newer = {.options = VXM_REPAIR_OPTIONS_INIT};
  vxm_mesh *repaired;
  newer.options.size = sizeof newer;
  assert_int_equal(vxm_mesh_repair(&repaired, NULL, mesh, &newer.options, &error), VXM_OK);
  vxm_mesh_destroy(repaired);
  for (int i = 0; i < MORE; i++) {
    newer.more[i] = 1;
    assert_int_equal(vxm_mesh_repair(&repaired, NULL, mesh, &newer.options, &error), VXM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, vxm_version()));
    newer.more[i] = 0;
  }
  /* an older program has no such field: whatever lies there is not read */
  vxm_repair_options older = VXM_REPAIR_OPTIONS_INIT;
  older.wrap_alpha = -7;
  assert_int_equal(vxm_mesh_repair(&repaired, NULL, mesh, &older, &error), VXM_ERROR_ARGUMENT);
  older.size = offsetof(vxm_repair_options, wrap_alpha);
  assert_int_equal(vxm_mesh_repair(&repaired, NULL, mesh, &older, &error), VXM_OK);
  vxm_mesh_destroy(repaired);
  const size_t none[] = {0, 1, sizeof(size_t) - 1, SIZE_MAX, (size_t)1 << 40};
  for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
    older.size = none[i];
    assert_int_equal(vxm_mesh_repair(&repaired, NULL, mesh, &older, &error), VXM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "initializer"));
  }
}

/** What an older program does not say has its default, which is not always 0. */
static void test_defaults_of_options(void **state) {
  (void)state;
  vxm_distance_report far = VXM_DISTANCE_REPORT_INIT, near = VXM_DISTANCE_REPORT_INIT;
  vxm_distance_options options = VXM_DISTANCE_OPTIONS_INIT;
  options.band = 0;
  const vxm_space *space = vxm_grid_space(grid);
  assert_int_equal(vxm_model_distance(values, &far, solid, space, &options, &error), VXM_OK);
  options.size = offsetof(vxm_distance_options, band);
  assert_int_equal(vxm_model_distance(values, &near, solid, space, &options, &error), VXM_OK);
  assert_true(near.exact < far.exact);
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  vxm_mesh *empty;
  arrays.tag_count = -1;
  assert_int_equal(vxm_mesh_create(&empty, NULL, &arrays, &error), VXM_ERROR_ARGUMENT);
  arrays.size = offsetof(vxm_mesh_arrays, tag_count);
  assert_int_equal(vxm_mesh_create(&empty, NULL, &arrays, &error), VXM_OK);
  vxm_mesh_destroy(empty);
}

static int set_up(void **state) {
  (void)state;
  static const vxm_space space = {{8, 8, 8}, {-3, -3, -3}, {1, 1, 1}};
  error = (vxm_error)VXM_ERROR_INIT;
  for (int i = 0; i < 8 * 8 * 8; i++)
    values[i] = (float)i;
  mesh = mesh_of_model(NULL, "cube");
  vxm_model_create(&solid, mesh, NULL, NULL);
  vxm_grid_create(&grid, NULL, &space, NULL);
  vxm_field_create(&field, NULL, &space, VXM_FIELD_NUMBERS, VXM_FLOAT32, values, NULL);
  vxm_sampler_create(&sampler, NULL, NULL, NULL);
  return vxm_sampler_put(sampler, 0, mesh, NULL) == VXM_OK && voxelize(NULL) == VXM_OK ? 0 : 1;
}

static int tear_down(void **state) {
  (void)state;
  vxm_sampler_destroy(sampler);
  vxm_field_destroy(field);
  vxm_grid_destroy(grid);
  vxm_model_destroy(solid);
  vxm_mesh_destroy(mesh);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_results),
      cmocka_unit_test(test_pointers_of_results),
      cmocka_unit_test(test_stride),
      cmocka_unit_test(test_options),
      cmocka_unit_test(test_defaults_of_options),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
