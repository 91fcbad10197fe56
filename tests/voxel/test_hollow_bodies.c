/* SPDX-License-Identifier: BSD-3-Clause */
/** Hollow boxes that overlap, lie in each other and in each other's walls. */
#include "../base/rounds.h"
#include "../mesh/hollow_boxes.h"

#include "mesh/geometry.h"
#include "repair/repair.h"
#include "voxmend.h"

#include <math.h>

static double wall_volume(const assembly *a) {
  double sum = 0;
  for (size_t i = 0; i < a->count; i++) {
    double skin = 1, in = 1;
    for (int axis = 0; axis < 3; axis++) {
      skin *= a->boxes[i].planes[axis][3] - a->boxes[i].planes[axis][0];
      bool bored = a->boxes[i].kind == HOLLOW_BORE && a->boxes[i].along == axis;
      in *= a->boxes[i].planes[axis][bored ? 3 : 2] - a->boxes[i].planes[axis][bored ? 0 : 1];
    }
    sum += skin - in;
  }
  return sum;
}

static double volume_of(const vxm_soup *soup) {
  double volume = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    const double *p = vxm_position(soup, corner[0]);
    volume +=
        vxm_polygon_cone((vxm_vec3){p[0], p[1], p[2]}, vxm_polygon_area(soup->positions, corner, count, 1));
  }
  return volume;
}

static void assert_cells(const vxm_soup *soup, const assembly *a, uint64_t seed, const char *what) {
  vxm_space space = {.dims = {1, 1, 1}, .voxel_size = {1, 1, 1}};
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  for (int axis = 0; axis < 3; axis++)
    space.dims[axis] = 4 * (int64_t)a->count;
  place.like = &space;
  options.thin = VXM_THIN_DROP;
  if (vxm_voxelize(&grid, NULL, soup, &place, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  int wrong = 0;
  int64_t at[3];
  for (at[2] = 0; at[2] < space.dims[2]; at[2]++)
    for (at[1] = 0; at[1] < space.dims[1]; at[1]++)
      for (at[0] = 0; at[0] < space.dims[0]; at[0]++)
        wrong += vxm_grid_get(grid, at[0], at[1], at[2]) != is_solid(a, at);
  vxm_grid_destroy(grid);
  if (wrong > 0)
    fail_msg("seed %llu, %zu boxes, %s: %d voxels are wrong", (unsigned long long)seed, a->count, what,
             wrong);
}

/** As the faces are, before they are voxelized, and after repairs that leave bodies as they are. */
static void assert_solid(vxm_context *context, const assembly *a, bool inside_out, uint64_t seed,
                         vxm_rng *rng) {
  static const vxm_level levels[] = {VXM_LEVEL_CLEAN, VXM_LEVEL_CLOSED};
  vxm_soup *bodies = faces_of(context, a, inside_out, rng), *soup = in_any_order(bodies, rng), *prepared;
  vxm_soup_destroy(bodies);
  assert_cells(soup, a, seed, "as it is");
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  assert_cells(prepared, a, seed, "prepared");
  vxm_soup_destroy(prepared);
  for (size_t l = 0; l < sizeof levels / sizeof *levels; l++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = levels[l];
    assert_int_equal(vxm_repair_run(&prepared, NULL, soup, &options, NULL), VXM_OK);
    if (fabs(volume_of(prepared) - wall_volume(a)) > 1e-6)
      fail_msg("seed %llu: the volume is %g instead of %g", (unsigned long long)seed, volume_of(prepared),
               wall_volume(a));
    assert_cells(prepared, a, seed, "repaired");
    vxm_soup_destroy(prepared);
  }
  vxm_soup_destroy(soup);
}

static void a_liner_in_a_vessel(void **state) {
  vxm_rng rng = {1};
  const assembly a = liner_in_vessel();
  for (int round = 0; round < 24; round++)
    assert_solid(*state, &a, round % 2 == 1, (uint64_t)round, &rng);
}

static void nested(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(200); seed++) {
    vxm_rng rng = {seed};
    assembly a = nested_boxes(2 + (size_t)vxm_rng_below(&rng, BODIES_MAX - 1), &rng);
    assert_solid(*state, &a, seed % 4 == 0, seed, &rng);
  }
}

static void overlapping(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(400); seed++) {
    vxm_rng rng = {seed};
    assembly a = random_boxes(2 + (size_t)vxm_rng_below(&rng, BODIES_MAX - 1), &rng);
    assert_solid(*state, &a, seed % 4 == 0, seed, &rng);
  }
}

/** Two voids in one box: what they share is filled by parity, which is told. */
static void voids_of_one_body(void **state) {
  for (int shift = 0; shift < 6; shift++) {
    const hollow_box whole = {.planes = {{0, 2, 6, 14}, {0, 2, 6, 14}, {0, 2, 6, 14}}},
                     other = {.planes = {{0, 3 + shift, 8 + shift, 14}, {0, 3, 7, 14}, {0, 3, 7, 14}}};
    vxm_soup *soup = new_soup(*state);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_grid *grid;
    add_skin(soup, &whole, false, shift % 2 == 1);
    add_skin(soup, &whole, true, shift % 2 == 0);
    add_skin(soup, &other, true, shift % 2 == 0);
    for (int method = 0; method < 2; method++) {
      options.method = method ? VXM_METHOD_WINDING : VXM_METHOD_VOTE;
      assert_int_equal(vxm_voxelize(&grid, &report, soup, &place, &options, NULL), VXM_OK);
      assert_int_equal(report.filled_overlaps, method == 0 && 3 + shift < 6);
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(soup);
  }
}

static void voids_that_cut_through_rings(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(400); seed++) {
    vxm_rng rng = {seed};
    assembly a = ring_in_void(&rng);
    assert_solid(*state, &a, seed % 4 == 0, seed, &rng);
  }
}

static void overlapping_with_bores(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(400); seed++) {
    vxm_rng rng = {seed};
    assembly a = random_boxes(2 + (size_t)vxm_rng_below(&rng, BODIES_MAX - 1), &rng);
    for (size_t i = 1; i < a.count; i++) {
      a.boxes[i].kind = vxm_rng_below(&rng, 3) > 0 ? HOLLOW_BORE : HOLLOW_VOID;
      a.boxes[i].along = (int)vxm_rng_below(&rng, 3);
    }
    assert_solid(*state, &a, seed % 4 == 0, seed, &rng);
  }
}

static int64_t turned(const vxm_repair_report *report) {
  for (int i = 0; i < report->pass_count; i++)
    if (strcmp(report->passes[i].pass, "orientation") == 0)
      return report->passes[i].count;
  return 0;
}

/** Two tubes one in the other, whose ends are open: they look the same whichever axis they stand along, and
 * no face of theirs has to be turned. */
static void pipes_without_ends(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(60); seed++) {
    vxm_rng rng = {seed};
    assembly a = random_boxes(1, &rng);
    int along = (int)seed % 3, *planes = a.boxes[0].planes[along], shorter = (int)vxm_rng_below(&rng, 2);
    a.boxes[0].kind = HOLLOW_PIPE;
    a.boxes[0].along = along;
    planes[1] = planes[0] + shorter;
    planes[2] = planes[3] - shorter;
    vxm_soup *soup = faces_of(*state, &a, seed % 4 == 0, &rng), *prepared;
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    options.level = VXM_LEVEL_CLEAN;
    assert_cells(soup, &a, seed, "as it is");
    assert_int_equal(vxm_repair_run(&prepared, &report, soup, &options, NULL), VXM_OK);
    assert_cells(prepared, &a, seed, "repaired");
    assert_int_equal(turned(&report), seed % 4 == 0 ? 8 : 0);
    vxm_soup_destroy(prepared);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_liner_in_a_vessel),
                                     cmocka_unit_test(nested),
                                     cmocka_unit_test(overlapping),
                                     cmocka_unit_test(voids_of_one_body),
                                     cmocka_unit_test(voids_that_cut_through_rings),
                                     cmocka_unit_test(overlapping_with_bores),
                                     cmocka_unit_test(pipes_without_ends)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
