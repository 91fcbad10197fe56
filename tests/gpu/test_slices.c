/* SPDX-License-Identifier: BSD-3-Clause */
/* Solids by slices, by both programs and along every axis, agree with the CPU but for voxels within 1/128 of
 * the surface; a displacement moves what it should, the same way each time. */
#include "gpu_test.h"

#include "tolerance.h"

static vxm_engine_options with(vxm_gl_method method, int axis) {
  vxm_engine_options options = VXM_ENGINE_OPTIONS_INIT;
  options.gl_method = method;
  options.slice_axis = axis;
  return options;
}

static vxm_engine *engine_with(const vxm_engine_options *options) {
  vxm_engine *made;
  assert_int_equal(vxm_engine_create(&made, context, ENGINE, options, NULL), VXM_OK);
  return made;
}

/** How many voxels differ; each lies close to the surface. */
static int64_t check(const vxm_soup *soup, const vxm_space *space, vxm_engine *by, vxm_split_mode parts) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_voxelize_report by_cpu = VXM_VOXELIZE_REPORT_INIT, by_gpu = VXM_VOXELIZE_REPORT_INIT;
  options.split_mode = parts;
  vxm_grid *expected = engine_solid(soup, space, &options, &by_cpu);
  options.engine = by;
  vxm_grid *found = engine_solid(soup, space, &options, &by_gpu);
  difference d = differ(expected, found, soup);
  if (d.farthest > 1.0 / 128)
    fail_msg("%lld voxels differ, %g from the surface", (long long)d.count, d.farthest);
  if (d.count == 0)
    assert_equal_reports(&by_cpu, &by_gpu);
  vxm_grid_destroy(expected);
  vxm_grid_destroy(found);
  return d.count;
}

static void test_agree(void **state) {
  (void)state;
  vxm_rng rng = {21};
  int64_t differing = 0, checked = 0;
  for (int method = VXM_GL_SLICES; method <= VXM_GL_TETRA_VERTEX; method++)
    for (int axis = 0; axis < 3; axis++) {
      vxm_engine_options options = with((vxm_gl_method)method, axis);
      vxm_engine *by = engine_with(&options);
      for (int round = 0; round < 3; round++) {
        vxm_soup *soup = shape_empty(context);
        vxm_space space = engine_space(40 + round, 37, 70);
        double high[3] = {44, 40, 75};
        for (int b = 0; b <= 2 * round; b++)
          random_octahedron(soup, &rng, (double[3]){-4, -3, -5}, high, round == 2 && b == 1);
        for (int parts = VXM_SPLIT_MODE_AUTO; parts <= VXM_SPLIT_MODE_WHOLE; parts++, checked++)
          differing += check(soup, &space, by, (vxm_split_mode)parts);
        vxm_soup_destroy(soup);
      }
      vxm_engine_destroy(by);
    }
  print_message("%lld voxels differ in %lld grids\n", (long long)differing, (long long)checked);
  assert_int_equal(differing, 0); /* a quarter of the points lie on centres */
}

/** Boxes whose faces and edges lie on centres: ties go the way of the CPU. */
static void test_ties(void **state) {
  (void)state;
  vxm_space space = engine_space(16, 16, 16);
  for (int method = VXM_GL_SLICES; method <= VXM_GL_TETRA_VERTEX; method++)
    for (int axis = 0; axis < 3; axis++) {
      vxm_engine_options options = with((vxm_gl_method)method, axis);
      vxm_engine *by = engine_with(&options);
      for (int quarters = 0; quarters <= 4; quarters++) {
        vxm_soup *soup = box_with_ties(quarters / 4.0, 0.5);
        assert_int_equal(check(soup, &space, by, VXM_SPLIT_MODE_AUTO), 0);
        vxm_soup_destroy(soup);
      }
      vxm_engine_destroy(by);
    }
}

/** Few layers and small viewports. */
static void test_limits(void **state) {
  (void)state;
  vxm_rng rng = {22};
  vxm_engine_options options = with(VXM_GL_SLICES, 0);
  vxm_engine *by = engine_with(&options);
  by->info.layers = 5;
  by->info.viewport = 13;
  vxm_soup *soup = shape_empty(context);
  random_octahedron(soup, &rng, (double[3]){-4, -3, -5}, (double[3]){50, 40, 40}, 0);
  vxm_space space = engine_space(45, 37, 33);
  assert_int_equal(check(soup, &space, by, VXM_SPLIT_MODE_AUTO), 0);
  by->info.block_bytes = 8192; /* tiles of several slices */
  assert_int_equal(check(soup, &space, by, VXM_SPLIT_MODE_AUTO), 0);
  vxm_soup_destroy(soup);
  vxm_engine_destroy(by);
}

/** The vertices move, all faces of one together, and as the seed says. */
static void test_displacement(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 40, 20, 20, 8, (double[3]){32, 32, 32});
  vxm_space space = engine_space(64, 64, 64);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *still = engine_solid(soup, &space, &options, NULL), *moved[3];
  for (int i = 0; i < 3; i++) {
    vxm_engine_options tuned = with(i == 2 ? VXM_GL_TETRA_VERTEX : VXM_GL_SLICES, 1);
    tuned.displacement = 1.5;
    tuned.seed = i == 1 ? 5 : 4;
    options.engine = engine_with(&tuned);
    moved[i] = engine_solid(soup, &space, &options, NULL);
    vxm_engine_destroy(options.engine);
  }
  assert_equal_bits(moved[0], moved[2]);
  vxm_comparison seeds = VXM_COMPARISON_INIT, away = VXM_COMPARISON_INIT;
  assert_int_equal(vxm_grid_compare(&seeds, moved[0], moved[1], NULL), VXM_OK);
  assert_int_equal(vxm_grid_compare(&away, still, moved[0], NULL), VXM_OK);
  assert_true(seeds.only_a > 100 && seeds.only_b > 100);
  assert_true(away.only_a > 100 && away.only_b > 100 && away.iou > 0.7);
  for (int64_t k = 0; k < 64; k++) /* no streak, and nothing farther out than vertices are moved */
    for (int64_t j = 0; j < 64; j++)
      for (int64_t i = 0; i < 64; i++)
        if (vxm_grid_get(moved[0], i, j, k) != vxm_grid_get(still, i, j, k))
          assert_true(distance_of(soup, &space, (int64_t[3]){i, j, k}) < 2.7);
  vxm_grid_destroy(still);
  for (int i = 0; i < 3; i++)
    vxm_grid_destroy(moved[i]);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_agree), cmocka_unit_test(test_ties),
                                     cmocka_unit_test(test_limits), cmocka_unit_test(test_displacement)};
  int status = gpu_test_start(NULL);
  vxm_engine_destroy(engine);
  return status ? status : cmocka_run_group_tests_name("slices by " ENGINE, tests, setup, teardown);
}
