/* SPDX-License-Identifier: BSD-3-Clause */
/** The published methods against the library's own voxels, bit for bit where the papers promise the same. */
#include "../voxel/shapes.h"
#include "voxmend.h"
#include "voxmend/experimental.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 24 };

static vxm_grid *grid_make(int64_t n) {
  const vxm_space space = {{n, n - 3, n + 5}, {-3, -3, -3}, {1, 1, 1}};
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  return grid;
}

static vxm_baseline_report run(vxm_grid *grid, const vxm_soup *soup, const vxm_baseline_options *options) {
  vxm_baseline_report report = VXM_BASELINE_REPORT_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid_set(grid, 0, 0, 0, true); /* what was there does not matter */
  if (vxm_baseline_voxelize(grid, &report, soup, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return report;
}

static vxm_grid *baseline(const vxm_soup *soup, vxm_baseline method) {
  vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
  vxm_grid *grid = grid_make(SIZE);
  options.method = method;
  run(grid, soup, &options);
  return grid;
}

static vxm_grid *ours(const vxm_soup *soup, const vxm_voxelize_options *options) {
  vxm_grid *grid = grid_make(SIZE);
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *model;
  if (vxm_model_create(&model, soup, options, &error) != VXM_OK ||
      vxm_model_voxelize(grid, NULL, model, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_model_destroy(model);
  return grid;
}

static vxm_grid *solid(const vxm_soup *soup, vxm_method method, vxm_split_mode split) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = method;
  options.split_mode = split;
  return ours(soup, &options);
}

static vxm_grid *surface(const vxm_soup *soup, vxm_surface_kind kind) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  options.surface = kind;
  return ours(soup, &options);
}

/** Drops both. */
static void assert_same(vxm_grid *a, vxm_grid *b) {
  assert_int_equal(vxm_grid_count(a), vxm_grid_count(b));
  assert_true(vxm_grid_hash(a) == vxm_grid_hash(b));
  vxm_grid_destroy(a);
  vxm_grid_destroy(b);
}

/** Whether all that `part` has is in `whole`; drops `part`. */
static void assert_within(vxm_grid *part, const vxm_grid *whole) {
  vxm_comparison made = VXM_COMPARISON_INIT;
  assert_int_equal(vxm_grid_compare(&made, part, whole, NULL), VXM_OK);
  assert_int_equal(made.only_a, 0);
  vxm_grid_destroy(part);
}

/** Closed bodies that cut through each other, with many corners exactly on centres and borders of voxels. */
static vxm_soup *random_bodies(uint64_t seed, int bodies) {
  vxm_soup *soup = shape_empty(context);
  vxm_rng rng = {seed};
  for (int i = 0; i < bodies; i++)
    shape_random_octahedron(soup, &rng, -8, 64);
  return soup;
}

static vxm_soup *ring(void) {
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 40, 20, 6.3, 2.9, (const double[]){8.1, 8.2, 8.3});
  return soup;
}

static void test_closed_solids(void **state) {
  static const vxm_baseline whole[] = {VXM_BASELINE_FANG_CHEN,    VXM_BASELINE_TETRA_LISTED,
                                       VXM_BASELINE_TETRA_FULL,   VXM_BASELINE_TETRA_ANEW,
                                       VXM_BASELINE_TETRA_LAYERS, VXM_BASELINE_EISEMANN};
  (void)state;
  for (uint64_t seed = 0; seed < 40; seed++) {
    vxm_soup *soup = seed == 0 ? ring() : random_bodies(seed, (int)(seed % 4) + 1);
    for (size_t m = 0; m < sizeof whole / sizeof *whole; m++)
      assert_same(baseline(soup, whole[m]), solid(soup, VXM_METHOD_X, VXM_SPLIT_MODE_WHOLE));
    assert_same(baseline(soup, VXM_BASELINE_CHEN_TU), solid(soup, VXM_METHOD_X, VXM_SPLIT_MODE_GROUP));
    vxm_soup_destroy(soup);
  }
}

/** Faces are missing: along each axis the parts are united, then two axes decide. */
static void test_open_groups(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed < 20; seed++) {
    vxm_soup *soup = random_bodies(seed, 3);
    vxm_soup *open = shape_empty(context);
    for (size_t v = 0; v < soup->vertex_count; v++) {
      const double *p = vxm_position(soup, v);
      shape_vertex(open, p[0], p[1], p[2]);
    }
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t n;
      const uint32_t *corner = vxm_face(soup, f, &n);
      if (f % 11 != seed % 11)
        shape_face(open, corner, n);
    }
    vxm_grid *made = baseline(open, VXM_BASELINE_CHEN_TU), *axis[3], *expected = grid_make(SIZE);
    for (int a = 0; a < 3; a++)
      axis[a] = solid(open, (vxm_method)(VXM_METHOD_X + a), VXM_SPLIT_MODE_GROUP);
    const int64_t *dims = vxm_grid_space(expected)->dims;
    for (int64_t k = 0; k < dims[2]; k++)
      for (int64_t j = 0; j < dims[1]; j++)
        for (int64_t i = 0; i < dims[0]; i++) {
          int votes = 0;
          for (int a = 0; a < 3; a++)
            votes += vxm_grid_get(axis[a], i, j, k);
          vxm_grid_set(expected, i, j, k, votes >= 2);
        }
    assert_same(made, expected);
    for (int a = 0; a < 3; a++)
      vxm_grid_destroy(axis[a]);
    vxm_soup_destroy(soup);
    vxm_soup_destroy(open);
  }
}

static void test_groups_are_counted(void **state) {
  (void)state;
  vxm_soup *soup = random_bodies(7, 5);
  vxm_grid *grid = grid_make(SIZE);
  vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
  options.method = VXM_BASELINE_CHEN_TU;
  vxm_baseline_report report = run(grid, soup, &options);
  assert_int_equal(report.parts, 5);
  assert_int_equal(report.triangles, 40);
  assert_true(report.rounds >= 2 && report.bytes > 0);
  options.method = VXM_BASELINE_FANG_CHEN;
  assert_int_equal(run(grid, soup, &options).parts, 1);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** Whatever the order of vertices, faces and corners, groups are what hangs together. */
static void test_groups_in_any_order(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed < 10; seed++) {
    enum { STRIPS = 5, LENGTH = 40, COUNT = STRIPS * LENGTH };
    vxm_soup *soup = shape_empty(context);
    vxm_rng rng = {seed};
    uint32_t number[COUNT];
    for (uint32_t v = 0; v < COUNT; v++) {
      uint32_t other = (uint32_t)vxm_rng_below(&rng, v + 1);
      number[v] = v;
      number[v] = number[other];
      number[other] = v;
      shape_vertex(soup, shape_quarter(&rng, 0, 60), shape_quarter(&rng, 0, 60), shape_quarter(&rng, 0, 60));
    }
    for (uint32_t v = 0; v + 2 < COUNT; v++) {
      uint32_t turn = (uint32_t)vxm_rng_below(&rng, 3), at = (v * 7) % COUNT;
      if (at % LENGTH + 2 < LENGTH)
        shape_triangle(soup, number[at + turn], number[at + (turn + 1) % 3], number[at + (turn + 2) % 3]);
    }
    for (uint32_t at = 0; at + 2 < COUNT; at++) /* those that the loop above leaves out */
      if (at % LENGTH + 2 < LENGTH)
        shape_triangle(soup, number[at], number[at + 1], number[at + 2]);
    vxm_grid *grid = grid_make(SIZE);
    vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
    options.method = VXM_BASELINE_CHEN_TU;
    assert_int_equal(run(grid, soup, &options).parts, STRIPS);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** Who asks which tetrahedra in which slices. */
static void test_tetrahedra_asked(void **state) {
  (void)state;
  vxm_soup *soup = ring();
  vxm_baseline_report report[4];
  vxm_grid *grid = grid_make(SIZE);
  for (int m = 0; m < 4; m++) {
    vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
    options.method = (vxm_baseline)(VXM_BASELINE_TETRA_LISTED + m);
    report[m] = run(grid, soup, &options);
  }
  int64_t slices = vxm_grid_space(grid)->dims[1];
  assert_int_equal(report[1].tests, slices * report[1].triangles);
  assert_int_equal(report[2].tests, report[1].tests);
  assert_true(report[0].tests < report[1].tests / 2);
  assert_int_equal(report[0].tests, report[3].tests);
  for (int m = 1; m < 4; m++)
    assert_int_equal(report[m].sections, report[0].sections);
  assert_int_equal(report[2].bytes, 0); /* nothing is kept */
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

static void test_surfaces(void **state) {
  (void)state;
  for (uint64_t seed = 0; seed < 40; seed++) {
    vxm_soup *soup = seed == 0 ? ring() : random_bodies(seed, 2);
    for (int kind = 0; kind < 2; kind++)
      for (int m = VXM_BASELINE_SIMPLE; m <= VXM_BASELINE_SORTED; m++) {
        vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
        vxm_grid *grid = grid_make(SIZE);
        options.method = (vxm_baseline)m;
        options.thin = kind == 1;
        vxm_baseline_report report = run(grid, soup, &options);
        assert_int_equal(report.boxes[0] + report.boxes[1] + report.boxes[2], report.triangles);
        assert_same(grid, surface(soup, kind == 1 ? VXM_SURFACE_THIN : VXM_SURFACE_CONSERVATIVE));
      }
    vxm_grid *zhang = baseline(soup, VXM_BASELINE_ZHANG), *density = baseline(soup, VXM_BASELINE_DENSITY);
    assert_within(surface(soup, VXM_SURFACE_CONSERVATIVE), zhang);
    assert_within(surface(soup, VXM_SURFACE_CONSERVATIVE), density);
    vxm_grid_destroy(zhang);
    vxm_grid_destroy(density);
    vxm_soup_destroy(soup);
  }
}

/** A triangle of each kind of box. */
static void test_kinds_of_boxes(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  static const double corners[3][3][3] = {{{0.2, 0.2, 0.2}, {3.7, 0.4, 0.3}, {2.1, 0.6, 0.7}},
                                          {{0.2, 5.2, 5.2}, {5.7, 9.4, 5.3}, {2.1, 7.6, 5.7}},
                                          {{0.2, 0.2, 9.2}, {5.7, 4.4, 12.3}, {2.1, 7.6, 15.7}}};
  for (int t = 0; t < 3; t++) {
    uint32_t v[3];
    for (int c = 0; c < 3; c++)
      v[c] = shape_vertex(soup, corners[t][c][0], corners[t][c][1], corners[t][c][2]);
    shape_triangle(soup, v[0], v[1], v[2]);
  }
  vxm_grid *grid = grid_make(SIZE);
  vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
  options.method = VXM_BASELINE_SIMPLE;
  vxm_baseline_report simple = run(grid, soup, &options);
  options.method = VXM_BASELINE_SORTED;
  vxm_baseline_report sorted = run(grid, soup, &options);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(simple.boxes[i], 1);
    assert_int_equal(sorted.boxes[i], 1);
  }
  assert_true(sorted.tests < simple.tests);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** The density is a line through the distance. */
static void test_density(void **state) {
  (void)state;
  vxm_soup *soup = ring();
  vxm_grid *grid = grid_make(SIZE);
  const vxm_space *space = vxm_grid_space(grid);
  const int64_t *dims = space->dims;
  size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
  uint8_t *density = malloc(count);
  float *distance = malloc(count * sizeof *distance);
  vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
  vxm_distance_options wanted = VXM_DISTANCE_OPTIONS_INIT;
  vxm_model *model;
  options.method = VXM_BASELINE_DENSITY;
  options.radius = 2.5;
  options.density = density;
  run(grid, soup, &options);
  wanted.is_unsigned = true;
  wanted.band = 4;
  assert_int_equal(vxm_model_create(&model, soup, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_model_distance(distance, NULL, model, space, &wanted, NULL), VXM_OK);
  for (int64_t i = 0; i < dims[0]; i++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t k = 0; k < dims[2]; k++) {
        double away = (double)distance[(i * dims[1] + j) * dims[2] + k];
        double expected = away < 2.5 ? 255 * (1 - away / 2.5) : 0;
        uint8_t made = density[(k * dims[1] + j) * dims[0] + i];
        assert_true(fabs(expected - made) < 0.51 + 255 * 0.001);
        assert_int_equal(vxm_grid_get(grid, i, j, k), made > 127);
      }
  free(density);
  free(distance);
  vxm_model_destroy(model);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

static void test_refused(void **state) {
  (void)state;
  vxm_error error = VXM_ERROR_INIT;
  vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
  vxm_soup *soup = shape_empty(context);
  vxm_grid *grid = grid_make(SIZE);
  assert_int_equal(vxm_baseline_voxelize(grid, NULL, soup, NULL, &error), VXM_ERROR_EMPTY);
  uint32_t a = shape_vertex(soup, 0, 0, 0), b = shape_vertex(soup, 1, 0, 0),
           c = shape_vertex(soup, 0, 1e4, 0);
  shape_triangle(soup, a, b, c);
  assert_int_equal(vxm_baseline_voxelize(grid, NULL, soup, NULL, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "choose larger voxels"));
  options.method = (vxm_baseline)99;
  assert_int_equal(vxm_baseline_voxelize(grid, NULL, soup, &options, &error), VXM_ERROR_ARGUMENT);
  options = (vxm_baseline_options)VXM_BASELINE_OPTIONS_INIT;
  options.radius = NAN;
  assert_int_equal(vxm_baseline_voxelize(grid, NULL, soup, &options, &error), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** Every method within every limit either works or says that memory is missing. */
static void test_memory(void **state) {
  (void)state;
  for (int m = 0; m <= VXM_BASELINE_EISEMANN; m++)
    for (uint64_t limit = 16; limit < 200; limit += 8) {
      vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
      vxm_context *small, *whole = context;
      limits.memory_limit = limit << 10;
      assert_int_equal(vxm_context_create(&small, &limits, NULL), VXM_OK);
      context = small;
      vxm_baseline_options options = VXM_BASELINE_OPTIONS_INIT;
      vxm_error error = VXM_ERROR_INIT;
      const vxm_space space = {{SIZE, SIZE, SIZE}, {-3, -3, -3}, {1, 1, 1}};
      vxm_grid *grid = NULL;
      options.method = (vxm_baseline)m;
      vxm_status status = vxm_grid_create(&grid, small, &space, &error);
      context = whole;
      vxm_soup *soup = ring();
      if (status == VXM_OK)
        status = vxm_baseline_voxelize(grid, NULL, soup, &options, &error);
      if (status != VXM_OK)
        assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
      vxm_context_destroy(small);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_closed_solids),
                                     cmocka_unit_test(test_open_groups),
                                     cmocka_unit_test(test_groups_are_counted),
                                     cmocka_unit_test(test_groups_in_any_order),
                                     cmocka_unit_test(test_tetrahedra_asked),
                                     cmocka_unit_test(test_surfaces),
                                     cmocka_unit_test(test_kinds_of_boxes),
                                     cmocka_unit_test(test_density),
                                     cmocka_unit_test(test_refused),
                                     cmocka_unit_test(test_memory)};
  return cmocka_run_group_tests_name("baselines", tests, setup, teardown);
}
