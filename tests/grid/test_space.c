/* SPDX-License-Identifier: BSD-3-Clause */
/* Choosing a voxel space: every fit, pad, bounds, and what is refused. */
#include "voxmend.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static vxm_mesh *mesh; /* a triangle in the box (1,2,3) to (5,4,3.5) */

static int setup(void **state) {
  (void)state;
  static const double vertices[] = {1, 2, 3, 5, 2, 3, 1, 4, 3.5, 900, 900, 900};
  static const int64_t indices[] = {0, 1, 2};
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = vertices;
  arrays.vertex_count = 4; /* the last one is used by no face and must not count */
  arrays.indices = indices;
  arrays.index_count = 3;
  arrays.face_count = 1;
  return vxm_mesh_create(&mesh, NULL, &arrays, NULL) != VXM_OK;
}

static int teardown(void **state) {
  (void)state;
  vxm_mesh_destroy(mesh);
  return 0;
}

static vxm_space chosen(const vxm_space_options *options) {
  vxm_space space;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_space_fit(&space, mesh, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return space;
}

static void assert_space(vxm_space s, int64_t nx, int64_t ny, int64_t nz, double size, double x, double y,
                         double z) {
  assert_int_equal(s.dims[0], nx);
  assert_int_equal(s.dims[1], ny);
  assert_int_equal(s.dims[2], nz);
  const double origin[3] = {x, y, z};
  for (int a = 0; a < 3; a++) {
    assert_true(fabs(s.voxel_size[a] - size) < 1e-12);
    assert_true(fabs(s.origin[a] - origin[a]) < 1e-12);
  }
}

static void test_cube(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.resolution[0] = 8;
  assert_space(chosen(&o), 8, 8, 8, 0.5, 1, 1, 1.25);
  o.pad = 2;
  assert_space(chosen(&o), 8, 8, 8, 1, -1, -1, -0.75);
  o.pad = 0;
  o.resolution[0] = 0;
  assert_int_equal(chosen(&o).dims[2], 128);
  o.voxel_size = 0.5;
  assert_space(chosen(&o), 8, 8, 8, 0.5, 1, 1, 1.25);
  o.pad = 1;
  assert_space(chosen(&o), 10, 10, 10, 0.5, 0.5, 0.5, 0.75);
}

static void test_three_sizes(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  memcpy(o.voxel_sizes, (double[]){0.5, 1, 0.25}, sizeof o.voxel_sizes);
  const vxm_space cube = {{8, 4, 16}, {1, 1, 1.25}, {0.5, 1, 0.25}};
  const vxm_space tight = {{10, 4, 4}, {0.5, 1, 2.75}, {0.5, 1, 0.25}};
  const vxm_space bounds = {{20, 5, 10}, {0, 0, 0}, {0.5, 1, 0.25}};
  vxm_space s = chosen(&o);
  assert_memory_equal(&s, &cube, sizeof s);
  o.fit = VXM_FIT_TIGHT;
  o.pad = 1;
  s = chosen(&o);
  assert_memory_equal(&s, &tight, sizeof s);
  o.pad = 0;
  o.use_bounds = true;
  memcpy(o.bounds, (double[]){0, 0, 0, 10, 5, 2.5}, sizeof o.bounds);
  s = chosen(&o);
  assert_memory_equal(&s, &bounds, sizeof s);
}

static void test_three_numbers(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.resolution[0] = 8;
  o.resolution[1] = 2;
  o.resolution[2] = 8;
  /* y decides: 2 units in 2 voxels */
  assert_space(chosen(&o), 8, 2, 8, 1, -1, 2, -0.75);
}

static void test_tight(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.fit = VXM_FIT_TIGHT;
  o.resolution[0] = 8;
  assert_space(chosen(&o), 8, 4, 1, 0.5, 1, 2, 3);
  o.pad = 1;
  o.resolution[0] = 10;
  assert_space(chosen(&o), 10, 6, 3, 0.5, 0.5, 1.5, 2.5);
  /* A side that is a whole number of voxels gains none by rounding. */
  o.pad = 0;
  for (int64_t n = 1; n < 2000; n++) {
    o.resolution[0] = n;
    assert_int_equal(chosen(&o).dims[0], n);
  }
}

static void test_sphere(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.fit = VXM_FIT_SPHERE;
  o.resolution[0] = 9;
  double size = sqrt(16 + 4 + 0.25) / 9;
  assert_space(chosen(&o), 9, 9, 9, size, 3 - 4.5 * size, 3 - 4.5 * size, 3.25 - 4.5 * size);
}

static void test_bounds(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.use_bounds = true;
  memcpy(o.bounds, (double[]){0, 0, 0, 10, 5, 2.5}, sizeof o.bounds);
  o.resolution[0] = 20;
  assert_space(chosen(&o), 20, 10, 5, 0.5, 0, 0, 0);
  o.resolution[1] = o.resolution[2] = 20;
  vxm_space s = chosen(&o);
  assert_int_equal(s.dims[1], 20);
  assert_true(s.voxel_size[0] == 0.5 && s.voxel_size[1] == 0.25 && s.voxel_size[2] == 0.125);
  memset(o.resolution, 0, sizeof o.resolution);
  o.voxel_size = 3;
  assert_space(chosen(&o), 4, 2, 1, 3, 0, 0, 0);
}

static void test_like(void **state) {
  (void)state;
  vxm_space like = {{3, 4, 5}, {6, 7, 8}, {1, 2, 3}};
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.like = &like;
  vxm_space s = chosen(&o);
  assert_memory_equal(&s, &like, sizeof s);
}

static void assert_refused(vxm_space_options o, vxm_status status) {
  vxm_space space;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_space_fit(&space, mesh, &o, &error), status);
  assert_int_equal(error.code, status);
  assert_true(strlen(error.text) > 10);
}

static void test_refusals(void **state) {
  (void)state;
  vxm_space_options o = VXM_SPACE_OPTIONS_INIT;
  o.size = 2;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  o = (vxm_space_options)VXM_SPACE_OPTIONS_INIT;
  o.resolution[0] = 4;
  o.pad = 2;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  o.pad = 0;
  o.voxel_size = 1;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  o = (vxm_space_options)VXM_SPACE_OPTIONS_INIT;
  o.resolution[1] = 5;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  o.resolution[1] = 0;
  o.resolution[0] = INT64_C(1) << 21;
  assert_refused(o, VXM_ERROR_RANGE);
  o.resolution[0] = 0;
  o.voxel_size = 1e-300;
  assert_refused(o, VXM_ERROR_RANGE);
  o.voxel_size = NAN;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  o.voxel_size = 1;
  o.voxel_sizes[1] = 1;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  o.voxel_size = 0;
  assert_refused(o, VXM_ERROR_ARGUMENT); /* two of three sizes are 0 */
  o.voxel_sizes[0] = o.voxel_sizes[2] = INFINITY;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  memset(o.voxel_sizes, 0, sizeof o.voxel_sizes);
  o.use_bounds = true;
  assert_refused(o, VXM_ERROR_ARGUMENT);
  memcpy(o.bounds, (double[]){0, 0, 0, 1, 1, INFINITY}, sizeof o.bounds);
  assert_refused(o, VXM_ERROR_ARGUMENT);
}

static void test_nothing_to_fit(void **state) {
  (void)state;
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  vxm_mesh *empty, *point;
  vxm_space space;
  assert_int_equal(vxm_mesh_create(&empty, NULL, &arrays, NULL), VXM_OK);
  assert_int_equal(vxm_space_fit(&space, empty, NULL, NULL), VXM_ERROR_EMPTY);
  vxm_mesh_destroy(empty);
  arrays.vertices = (double[]){7, 7, 7};
  arrays.vertex_count = 1;
  arrays.indices = (int64_t[]){0, 0, 0};
  arrays.index_count = 3;
  arrays.face_count = 1;
  assert_int_equal(vxm_mesh_create(&point, NULL, &arrays, NULL), VXM_OK);
  assert_int_equal(vxm_space_fit(&space, point, NULL, NULL), VXM_ERROR_EMPTY);
  vxm_mesh_destroy(point);
}

/** A triangle of that width in the plane z = 0. */
static vxm_mesh *mesh_of_size(double size) {
  const double vertices[] = {0, 0, 0, size, 0, 0, 0, size, 0};
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = vertices;
  arrays.vertex_count = 3;
  arrays.indices = (int64_t[]){0, 1, 2};
  arrays.index_count = 3;
  arrays.face_count = 1;
  vxm_mesh *out;
  assert_int_equal(vxm_mesh_create(&out, NULL, &arrays, NULL), VXM_OK);
  return out;
}

static void assert_told(const vxm_mesh *of, const vxm_space_options *options, const char *words) {
  vxm_space space;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_space_fit(&space, of, options, &error), VXM_ERROR_RANGE);
  if (!strstr(error.text, words))
    fail_msg("%s", error.text);
  error = (vxm_error)VXM_ERROR_INIT;
  assert_int_equal(vxm_voxelize(&grid, NULL, of, options, NULL, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, words));
}

/** Voxels of which no lattice can be made are told as such; those just above are made. */
static void test_too_small(void **state) {
  (void)state;
  static const double sizes[] = {0x1p-1074, 1e-310, 0x1p-1004 - 0x1p-1056};
  vxm_space_options options = VXM_SPACE_OPTIONS_INIT;
  options.resolution[0] = 8;
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    vxm_mesh *small = mesh_of_size(sizes[s]);
    for (int fit = VXM_FIT_CUBE; fit <= VXM_FIT_TIGHT; fit++) {
      options.fit = (vxm_fit)fit;
      assert_told(small, &options, "the model is too small to be divided into voxels");
    }
    vxm_mesh_destroy(small);
  }
  options.fit = VXM_FIT_CUBE;
  vxm_mesh *least = mesh_of_size(0x1p-1004);
  vxm_voxelize_options surface = VXM_VOXELIZE_OPTIONS_INIT;
  surface.mode = VXM_MODE_SURFACE;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, NULL, least, &options, &surface, NULL), VXM_OK);
  assert_true(vxm_grid_count(grid) > 28);
  vxm_grid_destroy(grid);

  vxm_space_options given = VXM_SPACE_OPTIONS_INIT;
  given.voxel_size = 0x1p-1008;
  assert_told(least, &given, "too small to be computed with");
  given.voxel_size = 0;
  const vxm_space like = {{8, 8, 8}, {0, 0, 0}, {1, 0x1p-1074, 1}};
  given.like = &like;
  assert_told(least, &given, "too small to be computed with");
  given.like = NULL;
  given.use_bounds = true;
  given.resolution[0] = 8;
  for (int a = 3; a < 6; a++)
    given.bounds[a] = 1e-310;
  assert_told(least, &given, "the bounds are too small");
  for (int a = 3; a < 6; a++)
    given.bounds[a] = 0x1p-1074;
  assert_told(least, &given, "the bounds are too small");
  given.resolution[1] = given.resolution[2] = 8;
  assert_told(least, &given, "the bounds are too small");

  vxm_model *model;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_model_create(&model, least, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_grid_create(&grid, NULL, &like, NULL), VXM_OK); /* such a grid may be */
  assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "too small to be computed with"));
  vxm_grid_destroy(grid);
  vxm_model_destroy(model);
  vxm_mesh_destroy(least);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cube),           cmocka_unit_test(test_three_sizes),
      cmocka_unit_test(test_three_numbers),  cmocka_unit_test(test_tight),
      cmocka_unit_test(test_sphere),         cmocka_unit_test(test_bounds),
      cmocka_unit_test(test_like),           cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_nothing_to_fit), cmocka_unit_test(test_too_small),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
