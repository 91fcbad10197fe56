/* SPDX-License-Identifier: BSD-3-Clause */
/** Closing where rims meet: the volumes are known from how the meshes are made. */
#include "repair_test.h"

#include <math.h>

/** Closes the soup and looks at what comes out. */
static void check_closed(vxm_soup *soup, int64_t components, double volume, double within) {
  for (int fills = 0; fills < 2; fills++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = fills ? VXM_LEVEL_CLOSED : VXM_LEVEL_CLEAN;
    options.fill_holes = -1;
    REPAIR_REPORT(report);
    vxm_soup *closed = repaired(soup, &options, &report);
    assert_true(report.after->closed);
    assert_int_equal(report.after->inconsistent_edges, 0);
    assert_int_equal(report.after->components, components);
    if (!(fabs(report.after->volume - volume) <= within))
      fail_msg("level %d: volume %.9g instead of %.9g", options.level, report.after->volume, volume);
    assert_repair_is_done(closed, &options);
    vxm_soup_destroy(closed);
  }
  vxm_soup_destroy(soup);
}

/* ---- Rims that meet ---- */

/** A rectangle with its corners on a lattice that is welded. */
static void add_wall(vxm_soup *soup, const double (*corners)[3]) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int c = 0; c < 4; c++)
    add_vertex(soup, corners[c][0], corners[c][1], corners[c][2]);
  add_face(soup, (uint32_t[]){first, first + 1, first + 2, first + 3}, 4);
}

/** Two chambers without a floor, and a wall between them: what is open is the floor, for both. */
static vxm_soup *chambers(vxm_context *context, bool turned) {
  vxm_soup *soup = new_soup(context);
  for (int c = 0; c < 2; c++) {
    double x = c, w = c + 1;
    add_wall(soup, (const double[][3]){{x, 0, 0}, {w, 0, 0}, {w, 0, 1}, {x, 0, 1}});
    add_wall(soup, (const double[][3]){{w, 1, 0}, {x, 1, 0}, {x, 1, 1}, {w, 1, 1}});
    add_wall(soup, (const double[][3]){{x, 0, 1}, {w, 0, 1}, {w, 1, 1}, {x, 1, 1}});
  }
  add_wall(soup, (const double[][3]){{0, 1, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 1}});
  add_wall(soup, (const double[][3]){{2, 0, 0}, {2, 1, 0}, {2, 1, 1}, {2, 0, 1}});
  if (turned)
    add_wall(soup, (const double[][3]){{1, 1, 0}, {1, 0, 0}, {1, 0, 1}, {1, 1, 1}});
  else
    add_wall(soup, (const double[][3]){{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}});
  return soup;
}

static void walls_within_leave_the_floor_whole(void **state) {
  for (int turned = 0; turned < 2; turned++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = VXM_LEVEL_CLOSED;
    options.sheets = VXM_SHEETS_DROP; /* the wall is one, then */
    REPAIR_REPORT(report);
    vxm_soup *soup = chambers(*state, turned);
    vxm_soup *closed = repaired(soup, &options, &report);
    assert_true(report.after->closed && report.after->nonmanifold_edges == 0);
    assert_int_equal(report.after->inconsistent_edges, 0);
    assert_int_equal(report.after->components, 1);
    assert_true(fabs(report.after->volume - 2) < 1e-12);
    assert_repair_is_done(closed, &options);
    vxm_soup_destroy(closed);
    vxm_soup_destroy(soup);
  }
}

/** A box without a top, with a slit down one side: the slit is closed along itself, the top flat. */
static void slits_at_a_rim_are_cut_off(void **state) {
  static const double points[][3] = {{0, 0, 0},    {1, 0, 0},     {1, 1, 0},   {0, 1, 0},
                                     {0, 0, 1},    {1, 0, 1},     {1, 1, 1},   {0, 1, 1},
                                     {0.49, 0, 1}, {0.5, 0, 0.1}, {0.51, 0, 1}};
  static const uint32_t quads[][4] = {{3, 2, 1, 0}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  vxm_soup *soup = new_soup(*state);
  for (size_t v = 0; v < sizeof points / sizeof *points; v++)
    add_vertex(soup, points[v][0], points[v][1], points[v][2]);
  for (size_t f = 0; f < sizeof quads / sizeof *quads; f++)
    add_face(soup, quads[f], 4);
  add_face(soup, (const uint32_t[]){0, 9, 8, 4}, 4);
  add_face(soup, (const uint32_t[]){1, 5, 10, 9}, 4);
  add_triangle(soup, 0, 1, 9);
  check_closed(soup, 1, 1, 1e-9);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_within_leave_the_floor_whole),
      cmocka_unit_test(slits_at_a_rim_are_cut_off),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
