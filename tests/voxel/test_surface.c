/* SPDX-License-Identifier: BSD-3-Clause */
/* The conservative surface against a brute-force separating-axis test of every voxel with every triangle. */
#include "shapes.h"

#include "grid/bitgrid.h"
#include "voxmend/voxelize.h"

#include <math.h>

static vxm_grid *voxelize(const vxm_soup *soup, const vxm_space *space, vxm_mode mode) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = space;
  options.mode = mode;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  if (vxm_voxelize(&grid, NULL, soup, &space_options, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

/** Whether box and triangle, in whole quarters of a voxel, lie apart along an axis: their projections do not
 * meet. */
static bool are_apart(const int64_t axis[3], const int64_t corner[3][3], const int64_t box[3]) {
  int64_t t_low = INT64_MAX, t_high = INT64_MIN, b_low = 0, b_high = 0;
  for (int c = 0; c < 3; c++) {
    int64_t at = 0;
    for (int a = 0; a < 3; a++)
      at += axis[a] * corner[c][a];
    t_low = at < t_low ? at : t_low;
    t_high = at > t_high ? at : t_high;
  }
  for (int a = 0; a < 3; a++) {
    int64_t p = axis[a] * box[a], q = axis[a] * (box[a] + 4);
    b_low += p < q ? p : q;
    b_high += p < q ? q : p;
  }
  return t_high < b_low || b_high < t_low;
}

/** The 13 axes of the separating-axis theorem for a box and a triangle, closed sets. */
static bool meet(const int64_t corner[3][3], const int64_t box[3]) {
  int64_t side[3][3], axis[3];
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      side[c][a] = corner[(c + 1) % 3][a] - corner[c][a];
  for (int k = 0; k < 3; k++) {
    int64_t unit[3] = {k == 0, k == 1, k == 2};
    if (are_apart(unit, corner, box))
      return false;
    for (int c = 0; c < 3; c++) {
      for (int a = 0; a < 3; a++)
        axis[a] = unit[(a + 1) % 3] * side[c][(a + 2) % 3] - unit[(a + 2) % 3] * side[c][(a + 1) % 3];
      if (are_apart(axis, corner, box))
        return false;
    }
  }
  for (int a = 0; a < 3; a++)
    axis[a] = side[0][(a + 1) % 3] * side[1][(a + 2) % 3] - side[0][(a + 2) % 3] * side[1][(a + 1) % 3];
  return !are_apart(axis, corner, box);
}

static void test_triangles_match_the_separating_axes(void **state) {
  (void)state;
  vxm_rng rng = {1};
  vxm_space space = {{7, 6, 5}, {0, 0, 0}, {1, 1, 1}};
  for (int round = 0; round < 4000; round++) {
    vxm_soup *soup = shape_empty(context);
    int64_t corner[3][3];
    /* Often flat along an axis, on voxel borders, thin, or a point. */
    int kind = round % 8;
    for (int c = 0; c < 3; c++) {
      double p[3];
      for (int a = 0; a < 3; a++) {
        p[a] = shape_quarter(&rng, -8, 36);
        if (kind == 1)
          p[a] = floor(p[a]);
        if (c > 0 && kind == 2 + a)
          p[a] = soup->positions[a];
        if (c > 0 && kind == 5)
          p[a] = soup->positions[a] + (a == 0 ? 0.25 * c : 0);
        if (c > 0 && kind == 6)
          p[a] = soup->positions[a];
        corner[c][a] = (int64_t)(4 * p[a]);
      }
      shape_vertex(soup, p[0], p[1], p[2]);
    }
    shape_triangle(soup, 0, 1, 2);
    vxm_grid *grid = voxelize(soup, &space, VXM_MODE_SURFACE);
    for (int64_t k = 0; k < 5; k++)
      for (int64_t j = 0; j < 6; j++)
        for (int64_t i = 0; i < 7; i++)
          assert_int_equal(vxm_grid_get(grid, i, j, k),
                           meet((const int64_t(*)[3])corner, (int64_t[]){4 * i, 4 * j, 4 * k}));
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** A polygon is covered alike whichever corner it begins with, and its bay stays free. */
static void test_a_bay_stays_free(void **state) {
  (void)state;
  static const double shape[][2] = {{0.5, 0.5}, {8.5, 0.5}, {8.5, 8.5}, {6.5, 8.5},
                                    {6.5, 2.5}, {2.5, 2.5}, {2.5, 8.5}, {0.5, 8.5}};
  vxm_space space = {{9, 9, 2}, {0, 0, 0}, {1, 1, 1}};
  for (int turn = 0; turn < 8; turn++) {
    vxm_soup *soup = shape_empty(context);
    uint32_t corner[8];
    for (int i = 0; i < 8; i++)
      corner[i] = shape_vertex(soup, shape[(i + turn) % 8][0], shape[(i + turn) % 8][1], 0.5);
    shape_face(soup, corner, 8);
    vxm_grid *grid = voxelize(soup, &space, VXM_MODE_SURFACE);
    assert_int_equal(vxm_grid_count(grid), 81 - 3 * 6);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

static void test_both_is_the_union(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 48, 24, 1, 0.4, (double[]){0.01, 0.02, 0.03});
  vxm_space space = {{70, 64, 40}, {-1.75, -1.6, -1}, {0.05, 0.05, 0.05}};
  vxm_grid *solid = voxelize(soup, &space, VXM_MODE_SOLID),
           *surface = voxelize(soup, &space, VXM_MODE_SURFACE);
  vxm_grid *both = voxelize(soup, &space, VXM_MODE_BOTH);
  for (size_t w = 0; w < both->word_count; w++)
    assert_true(both->words[w] == (solid->words[w] | surface->words[w]));
  assert_true(vxm_grid_count(both) > vxm_grid_count(solid));
  vxm_grid_destroy(both);
  vxm_grid_destroy(surface);
  vxm_grid_destroy(solid);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_triangles_match_the_separating_axes),
      cmocka_unit_test(test_a_bay_stays_free),
      cmocka_unit_test(test_both_is_the_union),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
