/* SPDX-License-Identifier: BSD-3-Clause */
/** How much of a surface lies outside of a grid, compared with the points of fine patterns on its triangles.
 */
#include "shapes.h"

#include "voxel/solid/overhang.h"

#include <math.h>
#include <string.h>

static const vxm_space unit_grid = {{8, 8, 8}, {0, 0, 0}, {0.125, 0.125, 0.125}};

static vxm_overhang overhang_of(const vxm_soup *soup, const vxm_space *space, const double transform[12]) {
  vxm_triangle_set triangles;
  vxm_error error = VXM_ERROR_INIT;
  vxm_split_rule rule = {VXM_SPLIT_MODE_AUTO, VXM_CAVITIES_AUTO, true};
  if (vxm_triangle_set_create(&triangles, soup, rule, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_overhang overhang = vxm_overhang_of(&triangles, space, transform);
  vxm_triangle_set_destroy(&triangles);
  return overhang;
}

/* ---- The oracle: equal small triangles, by their centres ---- */

enum { PER_SIDE = 200 };

typedef struct expected {
  double all, outside;
  bool below[3], above[3];
} expected;

static void add_point(expected *e, const double p[3], double area) {
  bool outside = false;
  for (int a = 0; a < 3; a++) {
    e->below[a] |= p[a] < -0.01;
    e->above[a] |= p[a] > 1.01;
    outside |= p[a] < 0 || p[a] > 1;
  }
  e->all += area;
  e->outside += outside ? area : 0;
}

static double area_of(const double t[3][3]) {
  double u[3], v[3];
  for (int a = 0; a < 3; a++) {
    u[a] = t[1][a] - t[0][a];
    v[a] = t[2][a] - t[0][a];
  }
  return 0.5 * hypot(hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2]), u[0] * v[1] - u[1] * v[0]);
}

static void add_triangle(expected *e, const double t[3][3]) {
  for (int i = 0; i < PER_SIDE; i++)
    for (int j = 0; i + j < PER_SIDE; j++)
      for (int up = 0; up < 2 && i + j + up < PER_SIDE; up++) {
        double p[3], u = (i + (1 + up) / 3.0) / PER_SIDE, v = (j + (1 + up) / 3.0) / PER_SIDE;
        for (int a = 0; a < 3; a++)
          p[a] = t[0][a] + u * (t[1][a] - t[0][a]) + v * (t[2][a] - t[0][a]);
        add_point(e, p, area_of(t) / (PER_SIDE * PER_SIDE));
      }
}

static void test_random_triangles(void **state) {
  (void)state;
  vxm_rng rng = {7};
  for (int round = 0; round < 40; round++) {
    vxm_soup *soup = shape_empty(context);
    expected want = {.all = 0};
    for (int n = 0; n < 1 + round % 3; n++) {
      double t[3][3];
      uint32_t corner[3];
      for (int c = 0; c < 3; c++) {
        for (int a = 0; a < 3; a++)
          t[c][a] = 3 * vxm_rng_unit(&rng) - 1;
        corner[c] = shape_vertex(soup, t[c][0], t[c][1], t[c][2]);
      }
      shape_face(soup, corner, 3);
      add_triangle(&want, (const double(*)[3])t);
    }
    vxm_overhang got = overhang_of(soup, &unit_grid, NULL);
    if (fabs(got.share - want.outside / want.all) > 0.03)
      fail_msg("round %d: %g rather than %g", round, got.share, want.outside / want.all);
    for (int a = 0; a < 3; a++)
      assert_true((got.below[a] || !want.below[a]) && (got.above[a] || !want.above[a]));
    vxm_soup_destroy(soup);
  }
}

/** A square across z. */
static vxm_soup *sheet_at(double z, double low, double high) {
  vxm_soup *soup = shape_empty(context);
  const uint32_t corner[4] = {shape_vertex(soup, low, low, z), shape_vertex(soup, high, low, z),
                              shape_vertex(soup, high, high, z), shape_vertex(soup, low, high, z)};
  shape_face(soup, corner, 4);
  return soup;
}

static void check_sheet(double z, double low, double high, double share, bool below, bool above) {
  vxm_soup *soup = sheet_at(z, low, high);
  vxm_overhang got = overhang_of(soup, &unit_grid, NULL);
  assert_true(fabs(got.share - share) < 0.01);
  assert_int_equal(got.below[2], below);
  assert_int_equal(got.above[2], above);
  vxm_soup_destroy(soup);
}

static void test_sheets_at_the_sides(void **state) {
  (void)state;
  check_sheet(0, 0, 1, 0, false, false);
  check_sheet(1, 0, 1, 0, false, false);
  check_sheet(-0.0005, 0, 1, 0, false, false); /* rounding */
  check_sheet(-0.125, 0, 1, 1, true, false);
  check_sheet(1.125, 0, 1, 1, false, true);
  check_sheet(0.5, 0, 2, 0.75, false, false);
  check_sheet(0.5, -1, 2, 8.0 / 9, false, false);
}

static void test_transforms(void **state) {
  (void)state;
  const double moved[12] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0};
  vxm_soup *soup = sheet_at(0.5, 0, 1);
  vxm_overhang got = overhang_of(soup, &unit_grid, moved);
  assert_true(fabs(got.share - 0.5) < 0.01 && got.above[0] && !got.below[0] && !got.above[1]);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_triangles),
                                     cmocka_unit_test(test_sheets_at_the_sides),
                                     cmocka_unit_test(test_transforms)};
  return cmocka_run_group_tests(tests, setup, teardown);
}
