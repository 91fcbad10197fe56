/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles that are huge, thin, far away or all in one place: exact, and no slower than what they cover. */
#include "engine.h"

#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/** Parity along all axes against the oracle. */
static void assert_exact(const vxm_soup *soup, const vxm_space *space) {
  size_t count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  uint8_t *want = malloc(count);
  assert_non_null(want);
  for (int w = 0; w < 3; w++) {
    memset(want, 0, count);
    exact_unite(want, soup, 0, soup->face_count, space, w);
    vxm_grid *grid = engine_method(soup, space, (vxm_method)(VXM_METHOD_X + w), VXM_SPLIT_MODE_WHOLE, NULL);
    assert_grid_is(grid, want);
    vxm_grid_destroy(grid);
  }
  free(want);
}

/** All methods of parity, and the votes, on a closed soup. */
static void assert_agree(const vxm_soup *soup, const vxm_space *space) {
  vxm_grid *x = engine_method(soup, space, VXM_METHOD_X, VXM_SPLIT_MODE_WHOLE, NULL);
  for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
    vxm_grid *grid = engine_method(soup, space, (vxm_method)method, VXM_SPLIT_MODE_WHOLE, NULL);
    assert_equal_bits(x, grid);
    vxm_grid_destroy(grid);
  }
  vxm_grid_destroy(x);
}

/* ---- Wide ---- */

/** Coordinates of up to 2^e voxels on all sides of a small grid, near it and in between. */
static vxm_soup *far_soup(vxm_rng *rng, int exponent, bool closed) {
  vxm_soup *soup = shape_empty(context);
  uint32_t v[6];
  for (int i = 0; i < 6; i++) {
    double p[3];
    for (int a = 0; a < 3; a++) {
      double reach = ldexp(1, (int)vxm_rng_below(rng, (uint64_t)exponent + 1));
      p[a] = 4 + (2 * vxm_rng_unit(rng) - 1) * reach;
      if (vxm_rng_below(rng, 5) == 0)
        p[a] = floor(p[a]) + 0.5;
    }
    v[i] = shape_vertex(soup, p[0], p[1], p[2]);
  }
  for (uint32_t f = 0; f < (closed ? 8 : 5); f++)
    shape_triangle(soup, v[4 + f / 4], v[f % 4], v[(f + 1) % 4]);
  return soup;
}

/** With 16 bits below a voxel, 2^4 voxels are the narrow limit of a triangle, 2^13 of a point, and 2^24 the
 * end of the lattice. */
static void test_far_points_match_the_oracle(void **state) {
  (void)state;
  vxm_rng rng = {41};
  vxm_space space = engine_space(9, 8, 7);
  for (int round = 0; round < 700; round++) {
    vxm_soup *soup = far_soup(&rng, 2 + round % 22, round % 2);
    assert_exact(soup, &space);
    if (round % 2)
      assert_agree(soup, &space);
    vxm_soup_destroy(soup);
  }
}

static void test_far_points_of_long_grids(void **state) {
  (void)state;
  vxm_rng rng = {42};
  static const int64_t dims[][3] = {{1500, 3, 2}, {2, 1100, 4}, {3, 2, 900}, {70, 66, 3}};
  for (int round = 0; round < 80; round++) {
    const int64_t *n = dims[round % 4];
    vxm_space space = engine_space(n[0], n[1], n[2]);
    vxm_soup *soup = far_soup(&rng, 6 + round % 15, round % 2);
    assert_exact(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Vertices that no face uses may be anywhere and anything. */
static void test_unused_vertices_do_not_matter(void **state) {
  (void)state;
  static const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e30, 4e8, -1e10};
  vxm_space space = engine_space(12, 11, 10);
  for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_WINDING; method++) {
    vxm_rng rng = {43}, again = {43};
    vxm_soup *plain = shape_empty(context), *soup = shape_empty(context);
    random_octahedron(plain, &rng, (double[]){1, 1, 1}, (double[]){9, 9, 9}, method % 2 ? 2 : 0);
    for (int i = 0; i < 8; i++)
      shape_vertex(soup, odd[i], odd[(i + 1) % 8], odd[(i + 2) % 8]);
    random_octahedron(soup, &again, (double[]){1, 1, 1}, (double[]){9, 9, 9}, method % 2 ? 2 : 0);
    shape_vertex(soup, NAN, NAN, NAN);
    shape_vertex(soup, 1e300, 0, 0);
    vxm_grid *a = engine_method(plain, &space, (vxm_method)method, VXM_SPLIT_MODE_AUTO, NULL);
    vxm_grid *b = engine_method(soup, &space, (vxm_method)method, VXM_SPLIT_MODE_AUTO, NULL);
    assert_equal_bits(a, b);
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
    vxm_soup_destroy(plain);
    vxm_soup_destroy(soup);
  }
}

static void test_used_vertices_must_be_finite_and_near(void **state) {
  (void)state;
  static const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, 1e18, -1e18, 3e7};
  vxm_space space = engine_space(12, 11, 10);
  for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
    for (int axis = 0; axis < 3; axis++)
      for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_WINDING; method++) {
        vxm_soup *soup = shape_empty(context);
        shape_vertex(soup, NAN, 0, 0);
        triangle_box(soup, (double[]){2, 2, 2}, (double[]){6, 6, 6}, 0, false);
        soup->positions[3 * 5 + (size_t)axis] = odd[i];
        vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
        options.method = (vxm_method)method;
        vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
        space_options.like = &space;
        vxm_error error = VXM_ERROR_INIT;
        vxm_grid *grid;
        assert_int_equal(vxm_voxelize(&grid, NULL, soup, &space_options, &options, &error), VXM_ERROR_RANGE);
        assert_null(grid);
        assert_int_equal(error.code, VXM_ERROR_RANGE);
        assert_int_equal(error.element, 5);
        vxm_soup_destroy(soup);
      }
}

/** A mesh that is one point, asked in a space of its own: it has no inside, but is not lost. */
static void test_all_vertices_in_one_point(void **state) {
  (void)state;
  vxm_space space = engine_space(5, 5, 5);
  for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_WINDING; method++) {
    bool kept = method == VXM_METHOD_VOTE;
    vxm_soup *soup = shape_empty(context);
    for (int v = 0; v < 3; v++)
      shape_vertex(soup, 2, 2, 2);
    shape_triangle(soup, 0, 1, 2);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = (vxm_method)method;
    vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
    space_options.like = &space;
    vxm_grid *grid;
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_status status = vxm_voxelize(&grid, &report, soup, &space_options, &options, NULL);
    assert_true(status == VXM_OK ? report.voxels == kept : status == VXM_ERROR_EMPTY);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/* ---- Large, thin, crowded, elsewhere: exact counts, and time ---- */

/** A box a million voxels wide about the grid fills it; one that ends inside fills its share. */
static void test_huge_triangles_fill_the_grid(void **state) {
  (void)state;
  vxm_space space = engine_space(100, 90, 80);
  double start = now();
  for (int axis = 0; axis < 3; axis++)
    for (int side = 0; side < 3; side++) {
      double low[3] = {-1e6, -1e6, -1e6}, high[3] = {1e6, 1e6, 1e6};
      int64_t expected = 100 * 90 * 80;
      if (side == 1) {
        low[axis] = 30;
        expected = expected / space.dims[axis] * (space.dims[axis] - 30);
      } else if (side == 2) {
        high[axis] = 30;
        expected = expected / space.dims[axis] * 30;
      }
      vxm_soup *soup = shape_empty(context);
      triangle_box(soup, low, high, 0, false);
      for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
        vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
        vxm_grid_destroy(engine_method(soup, &space, (vxm_method)method, VXM_SPLIT_MODE_AUTO, &report));
        assert_int_equal(report.voxels, expected);
      }
      vxm_soup_destroy(soup);
    }
  assert_true(now() - start < 30); /* a triangle in voxels is 10^12 columns */
}

/** Slivers a million voxels long through a small grid, along the axes and across. */
static void test_slivers(void **state) {
  (void)state;
  vxm_space space = engine_space(24, 23, 22);
  vxm_rng rng = {44};
  double start = now();
  for (int round = 0; round < 120; round++) {
    vxm_soup *soup = shape_empty(context);
    double d[3], at[3];
    for (int a = 0; a < 3; a++) {
      d[a] = round % 4 == a ? 1 : round % 4 == 3 ? 2 * vxm_rng_unit(&rng) - 1 : 1e-6 * vxm_rng_unit(&rng);
      at[a] = 4 + 14 * vxm_rng_unit(&rng);
    }
    uint32_t v[6];
    for (int i = 0; i < 6; i++) {
      double along = i < 4 ? 2e5 : i == 4 ? 1e6 : -1e6, p[3];
      for (int a = 0; a < 3; a++)
        p[a] = at[a] + d[a] * (i < 4 ? along * (vxm_rng_unit(&rng) - 0.5) : along) +
               (i < 4 ? 3 * vxm_rng_unit(&rng) : 0);
      v[i] = shape_vertex(soup, p[0], p[1], p[2]);
    }
    for (uint32_t f = 0; f < 8; f++)
      shape_triangle(soup, v[4 + f / 4], v[f % 4], v[(f + 1) % 4]);
    assert_exact(soup, &space);
    assert_agree(soup, &space);
    vxm_soup_destroy(soup);
  }
  assert_true(now() - start < 30);
}

/** Slivers and walls that lie in the plane of an axis, or nearly so: slopes beyond 64 bits. */
static void test_steep_triangles(void **state) {
  (void)state;
  vxm_rng rng = {45};
  for (int round = 0; round < 300; round++) {
    vxm_space space = engine_space(6, 7, 8);
    vxm_soup *soup = shape_empty(context);
    int axis = round % 3;
    double far = ldexp(1, 6 + round / 3 % 18) * 0.7;
    for (int v = 0; v < 3; v++) {
      double p[3];
      for (int a = 0; a < 3; a++)
        p[a] = 3 + far * (2 * vxm_rng_unit(&rng) - 1);
      p[axis] = 3.5 + (round % 2 ? 1e-5 : 1e-3) * (double)vxm_rng_below(&rng, 4);
      shape_vertex(soup, p[0], p[1], p[2]);
    }
    shape_triangle(soup, 0, 1, 2);
    assert_exact(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** 100 000 triangles that cover one column. */
static void test_all_triangles_in_one_column(void **state) {
  (void)state;
  enum { BOXES = 8192 };
  vxm_space space = engine_space(64, 48, 40);
  for (int axis = 0; axis < 3; axis++) {
    vxm_soup *soup = shape_empty(context);
    vxm_rng rng = {46};
    int64_t top = 0;
    bool odd[64] = {false};
    for (int i = 0; i < BOXES; i++) {
      int64_t from = (int64_t)vxm_rng_below(&rng, 30), to = from + 1 + (int64_t)vxm_rng_below(&rng, 8);
      double low[3] = {20, 20, 20}, high[3] = {21, 21, 21};
      low[axis] = (double)from;
      high[axis] = (double)to;
      triangle_box(soup, low, high, 0, false);
      for (int64_t w = from; w < to; w++)
        odd[w] = !odd[w];
      top = vxm_max(top, to);
    }
    int64_t expected = 0;
    for (int64_t w = 0; w < top; w++)
      expected += odd[w];
    double start = now();
    for (int method = VXM_METHOD_X; method <= VXM_METHOD_Z; method++) {
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid_destroy(engine_method(soup, &space, (vxm_method)method, VXM_SPLIT_MODE_WHOLE, &report));
      assert_int_equal(report.voxels, expected);
      vxm_grid_destroy(engine_method(soup, &space, (vxm_method)method, VXM_SPLIT_MODE_GROUP, &report));
      assert_int_equal(report.voxels, top);
      assert_int_equal(report.parts, BOXES);
      assert_int_equal(report.empty_parts, 0);
    }
    assert_true(now() - start < 30);
    vxm_soup_destroy(soup);
  }
}

/** Meshes wholly outside the grid, on each side and at several distances. */
static void test_meshes_outside_the_grid(void **state) {
  (void)state;
  static const double far[] = {0, 3, 1e4, 1e6};
  vxm_space space = engine_space(40, 30, 20);
  for (int axis = 0; axis < 3; axis++)
    for (int side = 0; side < 2; side++)
      for (int f = 0; f < 4; f++)
        for (int open = 0; open < 2; open++) {
          double low[3] = {5, 5, 5}, high[3] = {18, 18, 18};
          low[axis] = side ? (double)space.dims[axis] + far[f] : -20 - far[f];
          high[axis] = low[axis] + 20;
          vxm_soup *soup = shape_empty(context);
          triangle_box(soup, low, high, open ? 2 : 0, false);
          for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
            vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
            vxm_grid *grid = engine_method(soup, &space, (vxm_method)method, VXM_SPLIT_MODE_AUTO, &report);
            if (!open || method == VXM_METHOD_VOTE) /* capped */
              assert_int_equal(report.voxels, 0);
            if (!open || method == VXM_METHOD_VOTE)
              assert_int_equal(report.empty_parts + report.outside_parts, 1);
            vxm_grid_destroy(grid);
          }
          if (open && f < 3)
            assert_exact(soup, &space);
          vxm_soup_destroy(soup);
        }
}

/** Boxes within boxes, much longer than wide, are found to be nested. */
static void test_nested_boxes_of_any_proportion(void **state) {
  (void)state;
  for (int length = 1; length < 20000; length *= 5)
    for (int axis = 0; axis < 3; axis++) {
      vxm_soup *soup = shape_empty(context);
      double size[3] = {2, 2, 2};
      size[axis] = 2 * length;
      for (int i = 0; i < 5; i++) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
          low[a] = size[a] * 0.09 * i;
          high[a] = size[a] - low[a];
        }
        triangle_box(soup, low, high, 0, i % 2 != 0);
      }
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
      space_options.resolution[0] = 30;
      vxm_grid *grid;
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      assert_int_equal(vxm_voxelize(&grid, &report, soup, &space_options, &options, NULL), VXM_OK);
      assert_int_equal(report.parts, 3); /* each with a cavity, in which the next one stands */
      assert_int_equal(report.cavities, 2);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_far_points_match_the_oracle),
      cmocka_unit_test(test_far_points_of_long_grids),
      cmocka_unit_test(test_unused_vertices_do_not_matter),
      cmocka_unit_test(test_used_vertices_must_be_finite_and_near),
      cmocka_unit_test(test_all_vertices_in_one_point),
      cmocka_unit_test(test_huge_triangles_fill_the_grid),
      cmocka_unit_test(test_slivers),
      cmocka_unit_test(test_steep_triangles),
      cmocka_unit_test(test_all_triangles_in_one_column),
      cmocka_unit_test(test_meshes_outside_the_grid),
      cmocka_unit_test(test_nested_boxes_of_any_proportion),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
