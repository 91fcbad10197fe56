/* SPDX-License-Identifier: BSD-3-Clause */
/* The coverage against counting in a dense grid of sub-voxels, and against volumes that are known. */
#include "shapes.h"

#include "grid/bitgrid.h"
#include "voxel/model/model.h"
#include "voxel/parity/kernels.h"

#include <math.h>
#include <stdlib.h>

static vxm_context *context_of(int threads, uint64_t limit) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.memory_limit = limit;
  vxm_context *made;
  assert_int_equal(vxm_context_create(&made, &options, NULL), VXM_OK);
  return made;
}

static vxm_model *model_of(const vxm_soup *soup, vxm_mode mode) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = mode;
  options.thin = VXM_THIN_DROP; /* of which shares know nothing */
  vxm_model *model;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_create(&model, soup, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return model;
}

static vxm_coverage_report cover(void *values, vxm_model *model, const vxm_space *space, int n,
                                 vxm_scalar scalar) {
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = n;
  options.scalar = scalar;
  static vxm_voxelize_report voxelize; /* of the last one */
  vxm_coverage_report report = VXM_COVERAGE_REPORT_INIT;
  report.voxelize = &voxelize;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_coverage(values, &report, model, space, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return report;
}

static size_t voxels_of(const vxm_space *space) {
  return (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
}

/** Sub-voxels of a voxel that are set. */
static int count_in(const vxm_grid *fine, int64_t i, int64_t j, int64_t k, int n) {
  int count = 0;
  for (int c = 0; c < n; c++)
    for (int b = 0; b < n; b++)
      for (int a = 0; a < n; a++)
        count += vxm_grid_get(fine, i * n + a, j * n + b, k * n + c);
  return count;
}

static void check_counts(const vxm_soup *soup, const vxm_space *space, int n, vxm_mode mode) {
  vxm_space finer = *space;
  for (int a = 0; a < 3; a++) {
    finer.dims[a] *= n;
    finer.voxel_size[a] /= n;
  }
  vxm_model *model = model_of(soup, mode);
  vxm_grid *fine;
  assert_int_equal(vxm_grid_create(&fine, soup->context, &finer, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(fine, NULL, model, NULL, NULL), VXM_OK);
  float *fractions = malloc(voxels_of(space) * sizeof *fractions);
  uint8_t *bytes = malloc(voxels_of(space));
  vxm_coverage_report report = cover(fractions, model, space, n, VXM_FLOAT32);
  cover(bytes, model, space, n, VXM_UINT8);
  size_t at = 0;
  int64_t full = 0, partial = 0, set = 0;
  int most = n * n * n;
  for (int64_t i = 0; i < space->dims[0]; i++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t k = 0; k < space->dims[2]; k++, at++) {
        int count = count_in(fine, i, j, k, n);
        set += count;
        full += count == most;
        partial += count > 0 && count < most;
        assert_true(fractions[at] == (float)count / (float)most);
        assert_int_equal(bytes[at], (int)floor(255.0 * count / most + 0.5));
      }
  assert_int_equal(report.full, full);
  assert_int_equal(report.partial, partial);
  assert_int_equal(report.voxelize->voxels, set);
  free(bytes);
  free(fractions);
  vxm_grid_destroy(fine);
  vxm_model_destroy(model);
}

static void test_equals_counting(void **state) {
  (void)state;
  static const int subdivisions[] = {2, 4, 8};
  vxm_rng rng = {11};
  for (int round = 0; round < 24; round++) {
    vxm_context *own = context_of(1 + round % 3, 0);
    vxm_soup *soup = shape_empty(own);
    shape_random_octahedron(soup, &rng, -4, 60);
    shape_random_octahedron(soup, &rng, 0, 40);
    vxm_space space = {{1 + (int64_t)vxm_rng_below(&rng, 20), 1 + (int64_t)vxm_rng_below(&rng, 20),
                        1 + (int64_t)vxm_rng_below(&rng, 40)},
                       {0.5, 0.25, -0.5},
                       {0.7, 0.8, 0.45}};
    check_counts(soup, &space, subdivisions[round % 3], (vxm_mode)(round / 3 % 3));
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
}

/** Long rows with many parts, by every build of the kernels, also where memory is short: rows are then made
 * some at a time. */
static void test_many_parts_equal_counting(void **state) {
  (void)state;
  const vxm_kernels *builds[3];
  size_t build_count = vxm_kernels_all(builds);
  vxm_rng rng = {12};
  for (int round = 0; round < 12; round++) {
    vxm_context *own = context_of(1 + round % 2, round % 4 > 1 ? UINT64_C(24) << 20 : 0);
    vxm_soup *soup = shape_empty(own);
    for (int part = 0; part < 9; part++)
      shape_random_octahedron(soup, &rng, -10, 60);
    vxm_space space = {{9 + (int64_t)vxm_rng_below(&rng, 30), 10 + (int64_t)vxm_rng_below(&rng, 20),
                        60 + (int64_t)vxm_rng_below(&rng, 140)},
                       {-1.5, 0.25, -0.5},
                       {1.7, 1.8, 0.31}};
    vxm_kernels_force(builds[(size_t)round % build_count]);
    check_counts(soup, &space, 2 << round % 3, VXM_MODE_SOLID);
    vxm_kernels_force(NULL);
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
}

static void test_a_box_has_its_volume(void **state) {
  (void)state;
  /* Corners on borders of sub-voxels of the coarsest subdivision. */
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0.5, 1, 1.5}, (double[]){9, 7.5, 4});
  vxm_space space = {{10, 9, 6}, {0, 0, 0}, {1, 1, 1}};
  vxm_model *model = model_of(soup, VXM_MODE_SOLID);
  float values[540];
  for (int n = 2; n <= 8; n *= 2) {
    vxm_coverage_report report = cover(values, model, &space, n, VXM_FLOAT32);
    assert_true(report.volume == 8.5 * 6.5 * 2.5);
    assert_true(values[(0 * 9 + 3) * 6 + 2] == 0.5f && values[(0 * 9 + 7) * 6 + 1] == 0.125f);
    assert_true(values[(4 * 9 + 4) * 6 + 3] == 1 && values[(9 * 9 + 4) * 6 + 3] == 0);
    assert_int_equal(report.full, 8 * 6 * 2);
  }
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/** A sphere of so many triangles that its own volume differs by less than what is asked. */
static void test_a_sphere_sums_to_its_volume(void **state) {
  (void)state;
  enum { RINGS = 120, SIDES = 240 };
  vxm_soup *soup = shape_empty(context);
  uint32_t low = shape_vertex(soup, 0.01, 0.02, -0.97), high = shape_vertex(soup, 0.01, 0.02, 1.03);
  for (uint32_t r = 1; r < RINGS; r++)
    for (uint32_t s = 0; s < SIDES; s++) {
      double a = M_PI * r / RINGS, b = 2 * M_PI * s / SIDES;
      shape_vertex(soup, 0.01 + sin(a) * cos(b), 0.02 + sin(a) * sin(b), 0.03 - cos(a));
    }
  for (uint32_t s = 0; s < SIDES; s++) {
    uint32_t s1 = (s + 1) % SIDES, last = 2 + (RINGS - 2) * SIDES;
    shape_triangle(soup, low, 2 + s1, 2 + s);
    shape_triangle(soup, high, last + s, last + s1);
    for (uint32_t r = 0; r < RINGS - 2; r++)
      shape_face(soup,
                 (uint32_t[]){2 + r * SIDES + s, 2 + r * SIDES + s1, 2 + (r + 1) * SIDES + s1,
                              2 + (r + 1) * SIDES + s},
                 4);
  }
  vxm_space space = {{33, 34, 35}, {-1.05, -1.04, -1.03}, {0.064, 0.064, 0.064}};
  vxm_model *model = model_of(soup, VXM_MODE_SOLID);
  float *values = malloc(voxels_of(&space) * sizeof *values);
  double volume = 4 * M_PI / 3;
  for (int n = 2; n <= 8; n *= 2) {
    vxm_coverage_report report = cover(values, model, &space, n, VXM_FLOAT32);
    double sum = 0;
    for (size_t i = 0; i < voxels_of(&space); i++)
      sum += (double)values[i];
    sum *= 0.064 * 0.064 * 0.064;
    assert_true(fabs(sum - report.volume) < 1e-9 * volume);
    assert_true(fabs(sum - volume) < 1e-3 * volume);
  }
  free(values);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/** A limit far below the grid of sub-voxels is kept, and changes nothing. */
static void test_memory_limit(void **state) {
  (void)state;
  vxm_space space = {{100, 92, 90}, {-1.75, -1.6, -1.5}, {0.035, 0.035, 0.035}};
  uint8_t *values[2] = {malloc(voxels_of(&space)), malloc(voxels_of(&space))};
  for (int limited = 0; limited < 2; limited++) {
    uint64_t limit = limited ? UINT64_C(18) << 20 : 0; /* the sub-voxels take 52 MiB */
    vxm_context *own = context_of(1 + limited, limit);
    vxm_soup *soup = shape_empty(own);
    shape_torus(soup, 48, 24, 1, 0.4, (double[]){0.01, 0.02, 0.03});
    vxm_model *model = model_of(soup, VXM_MODE_SOLID);
    cover(values[limited], model, &space, 8, VXM_UINT8);
    assert_true(!limited || vxm_context_peak_bytes(own) <= limit);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  assert_memory_equal(values[0], values[1], voxels_of(&space));
  free(values[0]);
  free(values[1]);
}

static void test_what_is_refused(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 1});
  vxm_model *model = model_of(soup, VXM_MODE_SOLID);
  vxm_space space = {{1 << 18, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  float value[2] = {0};
  options.subdivision = 3;
  assert_int_equal(vxm_model_coverage(value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.subdivision = 8;
  assert_int_equal(vxm_model_coverage(value, NULL, model, &space, &options, NULL), VXM_ERROR_RANGE);
  options.subdivision = 2;
  void *beside = (char *)value + 1; /* where no float may lie */
  assert_int_equal(vxm_model_coverage(beside, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.scalar = VXM_FLOAT64;
  assert_int_equal(vxm_model_coverage(value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_model_coverage(NULL, NULL, model, &space, NULL, NULL), VXM_ERROR_ARGUMENT);
  options = (vxm_coverage_options)VXM_COVERAGE_OPTIONS_INIT;
  assert_int_equal(vxm_model_write_coverage(NULL, model, &space, "x.binvox", &options, NULL),
                   VXM_ERROR_ARGUMENT);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_equals_counting),      cmocka_unit_test(test_many_parts_equal_counting),
      cmocka_unit_test(test_a_box_has_its_volume), cmocka_unit_test(test_a_sphere_sums_to_its_volume),
      cmocka_unit_test(test_memory_limit),         cmocka_unit_test(test_what_is_refused),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
