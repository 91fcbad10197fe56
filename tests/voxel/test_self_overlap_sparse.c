/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Parts that lie in themselves, beside others: octrees and coverage, which are made of their crossings,
 * against grids, which test_self_overlap.c holds against solid angles. For all numbers of threads, in parts
 * of grids, moved, under memory limits, and cancelled.
 */
#include "../base/rounds.h"
#include "tubes.h"

#include "grid/octree.h"
#include "voxel/model/model.h"
#include "voxel/sparse/sparse.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Models ---- */

/** A band around a centre that goes around `turns` times, from one radius to another, extruded along z: wound
 * so often, but at its rim. */
static void add_spiral(vxm_soup *soup, uint32_t turns, double radius, double to, const double centre[2],
                       double low, double high) {
  enum { CORNERS = 12 };
  uint32_t n = turns * CORNERS, first = (uint32_t)soup->vertex_count;
  for (uint32_t i = 0; i < n; i++) {
    double angle = 6.283185307179586 * i / CORNERS, r = radius + (to - radius) * i / n;
    for (int side = 0; side < 2; side++)
      shape_vertex(soup, centre[0] + r * cos(angle), centre[1] + r * sin(angle), side ? high : low);
  }
  for (uint32_t i = 0; i < n; i++) {
    uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % n);
    shape_triangle(soup, a, b, b + 1);
    shape_triangle(soup, a, b + 1, a + 1);
  }
  for (uint32_t i = 1; i + 1 < n; i++) {
    shape_triangle(soup, first, first + 2 * (i + 1), first + 2 * i);
    shape_triangle(soup, first + 1, first + 2 * i + 1, first + 2 * (i + 1) + 1);
  }
}

/** One part of a kind; some of them lie in themselves, some are turned inside out, or have a hole. */
static void add_part(vxm_soup *soup, vxm_rng *rng, int kind) {
  turning turned = random_turning(rng);
  size_t first = soup->face_count;
  switch (kind) {
  case 0:
    add_tube(soup, &turned, 0.4 * vxm_rng_unit(rng), 1.6 + 0.8 * vxm_rng_unit(rng));
    break;
  case 1:
    add_tube(soup, &turned, 6, 1.2);
    break;
  case 2:
    add_spiral(soup, 2 + (uint32_t)vxm_rng_below(rng, 25), 3, 7, (double[2]){10.1, 9.7}, 4.3, 15.2);
    break;
  case 3:
    shape_torus(soup, 12, 8, 6, 1.5, (double[3]){9.3, 9.7, 10.1});
    break;
  default:
    shape_random_octahedron(soup, rng, 0, 4 * WIDTH);
  }
  bool is_turned = vxm_rng_below(rng, 3) == 0;
  for (size_t f = first; f < soup->face_count && is_turned && kind != 3; f++)
    reverse_face(soup, f);
  if (kind == 0 && vxm_rng_below(rng, 3) == 0) {
    size_t ring = first + RINGS / 4 * 2 * SIDES; /* far from where the branches cross */
    for (size_t f = ring; f < ring + 2; f++)
      soup->indices[soup->offsets[f] + 1] = soup->indices[soup->offsets[f] + 2];
  }
}

static vxm_soup *random_soup(vxm_rng *rng) {
  vxm_soup *soup = shape_empty(context);
  int parts = 1 + (int)vxm_rng_below(rng, 4);
  add_part(soup, rng, 2 * (int)vxm_rng_below(rng, 2));
  for (int p = 1; p < parts; p++)
    add_part(soup, rng, (int)vxm_rng_below(rng, 5));
  return soup;
}

/** Some voxels along each axis, of all that the parts lie in or of a piece of it. */
static vxm_space random_space(vxm_rng *rng) {
  static const int64_t sides[] = {1, 5, 16, 17, 33, 64, 65, 90};
  vxm_space space = {.dims = {1, 1, 1}};
  double voxel = 0;
  for (int a = 0; a < 3; a++) {
    space.dims[a] = sides[vxm_rng_below(rng, sizeof sides / sizeof *sides)];
    voxel = fmax(voxel, 1 / (double)space.dims[a]);
  }
  voxel *= vxm_rng_below(rng, 2) ? WIDTH : WIDTH / 2;
  for (int a = 0; a < 3; a++) {
    space.voxel_size[a] = voxel;
    space.origin[a] = (WIDTH - (double)space.dims[a] * voxel) * vxm_rng_unit(rng);
  }
  return space;
}

static vxm_model *model_of(const vxm_soup *soup, const vxm_voxelize_options *options) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *model;
  if (vxm_model_create(&model, soup, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return model;
}

/* ---- Comparing ---- */

static vxm_grid *dense(vxm_model *model, const vxm_space *space, const double *transform,
                       vxm_voxelize_report *report) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, space, NULL), VXM_OK);
  if (vxm_model_voxelize(grid, report, model, transform, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

static void check_octree(vxm_model *model, const vxm_space *space, const double *transform) {
  vxm_voxelize_report expected = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid = dense(model, space, transform, &expected);
  for (int direct = 0; direct < 2; direct++) {
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_sparse *octree;
    vxm_grid *back;
    vxm_sparse_force_direct(direct);
    assert_int_equal(vxm_model_sparse(&octree, &report, model, space, transform, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_to_grid(&back, octree, NULL), VXM_OK);
    assert_memory_equal(back->words, grid->words, grid->word_count * sizeof *grid->words);
    assert_true(report.hash == expected.hash && report.voxels == expected.voxels);
    assert_int_equal(report.empty_parts, expected.empty_parts);
    assert_int_equal(report.self_overlapping_parts, expected.self_overlapping_parts);
    vxm_grid_destroy(back);
    vxm_sparse_destroy(octree);
  }
  vxm_sparse_force_direct(false);
  vxm_grid_destroy(grid);
}

/** A voxel is as full as its sub-voxels are many, which are the voxels of a grid so much finer. */
static void check_coverage(vxm_model *model, const vxm_space *space, int n) {
  vxm_space finer = *space;
  size_t count = 1;
  for (int a = 0; a < 3; a++) {
    count *= (size_t)space->dims[a];
    finer.dims[a] *= n;
    finer.voxel_size[a] /= n;
  }
  vxm_voxelize_report expected = VXM_VOXELIZE_REPORT_INIT, got = VXM_VOXELIZE_REPORT_INIT;
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = n;
  vxm_coverage_report report = VXM_COVERAGE_REPORT_INIT;
  report.voxelize = &got;
  float *share = malloc(count * sizeof *share), *at = share;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_coverage(share, &report, model, space, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_grid *grid = dense(model, &finer, NULL, &expected);
  for (int64_t x = 0; x < space->dims[0]; x++)
    for (int64_t y = 0; y < space->dims[1]; y++)
      for (int64_t z = 0; z < space->dims[2]; z++) {
        int set = 0;
        for (int i = 0; i < n * n * n; i++)
          set += vxm_grid_get(grid, n * x + i % n, n * y + i / n % n, n * z + i / n / n);
        assert_true(*at++ == (float)set / (float)(n * n * n));
      }
  assert_int_equal(got.voxels, expected.voxels);
  assert_int_equal(got.empty_parts, expected.empty_parts);
  vxm_grid_destroy(grid);
  free(share);
}

/** Makes a context the present one; returns that before. */
static vxm_context *enter(int threads, uint64_t memory) {
  vxm_context *before = context;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.memory_limit = memory;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  return before;
}

static void leave(vxm_context *before) {
  vxm_context_destroy(context);
  context = before;
}

/* ---- Tests ---- */

static void test_octrees(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  static const double moves[3][12] = {{0.8, -0.6, 0, 7.5, 0.6, 0.8, 0, -4.25, 0, 0, 1, 0.5},
                                      {-1, 0, 0, WIDTH, 0, 1, 0, 0, 0, 0, 1, 0},
                                      {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}};
  vxm_rng rng = {31};
  int overlapping = 0;
  for (int round = 0; round < ROUNDS(120); round++) {
    vxm_context *before = enter(threads[round % 3], 0);
    vxm_soup *soup = random_soup(&rng);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = round % 4 ? VXM_THIN_DROP : VXM_THIN_KEEP;
    options.mode = round % 7 ? VXM_MODE_SOLID : VXM_MODE_BOTH;
    vxm_model *model = model_of(soup, &options);
    vxm_space space = random_space(&rng);
    check_octree(model, &space, NULL);
    check_octree(model, &space, moves[round % 3]);
    overlapping += model->analysis.self_overlap.part_count > 0;
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    leave(before);
  }
  assert_true(overlapping > ROUNDS(120) / 2);
}

static void test_coverage(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  vxm_rng rng = {32};
  for (int round = 0; round < ROUNDS(36); round++) {
    vxm_context *before = enter(threads[round % 3], 0);
    vxm_soup *soup = random_soup(&rng);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = VXM_THIN_DROP;
    vxm_model *model = model_of(soup, &options);
    vxm_space space = random_space(&rng);
    for (int a = 0; a < 3; a++)
      space.dims[a] = vxm_min(space.dims[a], 24);
    check_coverage(model, &space, 2 << round / 3 % 3);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    leave(before);
  }
}

/** Where parity finds no voxel at all, a part is not empty for that. */
static void test_hollow(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  vxm_space space = {{WIDTH, WIDTH, WIDTH}, {0, 0, 0}, {1, 1, 1}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  add_spiral(soup, 2, 3, 3.0005, (double[2]){10.11, 10.23}, 4.3, 15.2);
  options.method = VXM_METHOD_X;
  vxm_model *model = model_of(soup, &options);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid_destroy(dense(model, &space, NULL, &report));
  assert_int_equal(report.voxels, 0);
  vxm_model_destroy(model);
  options.method = VXM_METHOD_VOTE;
  for (int part = 0; part < 2; part++) {
    model = model_of(soup, &options);
    report = (vxm_voxelize_report)VXM_VOXELIZE_REPORT_INIT;
    vxm_grid_destroy(dense(model, &space, NULL, &report));
    assert_true(report.voxels > 200 && report.empty_parts == 0);
    check_octree(model, &space, NULL);
    check_coverage(model, &space, 2);
    vxm_model_destroy(model);
    shape_box(soup, (double[3]){1, 1, 1}, (double[3]){9, 19, 19});
  }
  vxm_soup_destroy(soup);
}

static vxm_soup *limited_soup(void) {
  vxm_rng rng = {33};
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, context, "test", NULL), VXM_OK);
  for (int p = 0; p < 8; p++)
    add_part(soup, &rng, p % 2 ? 3 : 0);
  for (int p = 0; p < 12; p++)
    shape_box(soup, (double[3]){1 + 0.3 * p, 1, 1}, (double[3]){2 + p, 19, 19 - p});
  return soup;
}

/** Several windows and rounds, and too many crossings for any: the same, or an error. */
static void test_limits(void **state) {
  (void)state;
  static const vxm_space spaces[] = {{{400, 400, 200}, {0, 0, 5}, {0.05, 0.05, 0.05}},
                                     {{40, 2000, 16}, {9.8, 0, 9.9}, {0.01, 0.01, 0.01}}};
  for (int s = 0; s < 2; s++) {
    int failures = 0, successes = 0;
    uint64_t expected = 0;
    for (uint64_t limit = UINT64_C(1) << 36; limit > 1 << 18;
         limit = limit > 1 << 30 ? 1 << 28 : limit / 4 * 3) {
      vxm_context *before = enter(1 + (int)(limit / 4 % 3), limit);
      vxm_soup *soup = limited_soup();
      vxm_model *model = NULL;
      vxm_sparse *octree = NULL;
      vxm_error error = VXM_ERROR_INIT;
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.thin = VXM_THIN_DROP;
      vxm_status status = vxm_model_create(&model, soup, &options, &error);
      if (status == VXM_OK)
        status = vxm_model_sparse(&octree, NULL, model, &spaces[s], NULL, &error);
      assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
      assert_int_equal(error.code, status);
      assert_int_equal(octree != NULL, status == VXM_OK);
      if (octree && expected)
        assert_true(vxm_sparse_hash(octree) == expected);
      else if (octree) {
        expected = vxm_sparse_hash(octree);
        check_octree(model, &spaces[s], NULL);
      }
      failures += status != VXM_OK;
      successes += status == VXM_OK;
      vxm_sparse_destroy(octree);
      vxm_model_destroy(model);
      vxm_soup_destroy(soup);
      leave(before);
    }
    assert_true(failures > 2 && successes > 4);
  }
}

/** Coverage likewise: all slices at once, some, and by sub-voxels. */
static void test_coverage_limits(void **state) {
  (void)state;
  static const vxm_space space = {{150, 150, 80}, {0, 0, 5}, {0.13, 0.13, 0.13}};
  enum { COUNT = 150 * 150 * 80 };
  uint8_t *expected = malloc(COUNT), *got = malloc(COUNT);
  int failures = 0, successes = 0;
  for (uint64_t limit = UINT64_C(1) << 30; limit > 1 << 18; limit = limit / 4 * 3) {
    vxm_context *before = enter(1 + (int)(limit / 4 % 3), limit);
    vxm_soup *soup = limited_soup();
    vxm_model *model = NULL;
    vxm_error error = VXM_ERROR_INIT;
    vxm_voxelize_options centres = VXM_VOXELIZE_OPTIONS_INIT;
    centres.thin = VXM_THIN_DROP;
    vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
    options.subdivision = 4;
    options.scalar = VXM_UINT8;
    vxm_status status = vxm_model_create(&model, soup, &centres, &error);
    if (status == VXM_OK && successes == 0)
      check_coverage(model, &space, options.subdivision);
    if (status == VXM_OK)
      status = vxm_model_coverage(successes == 0 ? expected : got, NULL, model, &space, &options, &error);
    assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
    if (status == VXM_OK && successes > 0)
      assert_memory_equal(got, expected, COUNT);
    failures += status != VXM_OK;
    successes += status == VXM_OK;
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    leave(before);
  }
  assert_true(failures > 2 && successes > 4);
  free(got);
  free(expected);
}

typedef struct watcher {
  int left;
  char phase[64];
  double fraction;
} watcher;

static int stop_late(const char *phase, double fraction, void *payload) {
  watcher *w = payload;
  assert_true(fraction >= 0 && fraction <= 1);
  assert_true(strcmp(phase, w->phase) != 0 || fraction >= w->fraction);
  snprintf(w->phase, sizeof w->phase, "%s", phase);
  w->fraction = fraction;
  return --w->left < 0;
}

static void test_cancelling(void **state) {
  (void)state;
  vxm_context *shared = context;
  bool finished = false;
  for (int calls = 1; !finished && calls < 4000; calls = calls * 3 / 2 + 1) {
    watcher w = {calls, "", 0};
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.threads = 2;
    limits.progress = stop_late;
    limits.payload = &w;
    assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
    vxm_rng rng = {34};
    vxm_soup *soup = random_soup(&rng);
    vxm_space space = {{90, 90, 90}, {0, 0, 0}, {0.2, 0.2, 0.2}};
    vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
    float *share = malloc(90 * 90 * 90 * sizeof *share);
    vxm_model *model = NULL;
    vxm_sparse *octree = NULL;
    vxm_sparse_force_direct(true);
    vxm_status status = vxm_model_create(&model, soup, NULL, NULL);
    if (status == VXM_OK)
      status = vxm_model_sparse(&octree, NULL, model, &space, NULL, NULL);
    assert_int_equal(octree != NULL, status == VXM_OK);
    if (status == VXM_OK)
      status = vxm_model_coverage(share, NULL, model, &space, &options, NULL);
    assert_true(status == VXM_OK || status == VXM_ERROR_CANCELLED);
    finished = status == VXM_OK;
    vxm_sparse_force_direct(false);
    vxm_sparse_destroy(octree);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    free(share);
    vxm_context_destroy(context);
  }
  assert_true(finished);
  context = shared;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_octrees),         cmocka_unit_test(test_coverage),
      cmocka_unit_test(test_hollow),          cmocka_unit_test(test_limits),
      cmocka_unit_test(test_coverage_limits), cmocka_unit_test(test_cancelling),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
