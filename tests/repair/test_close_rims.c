/* SPDX-License-Identifier: BSD-3-Clause */
/** Closing where rims meet, or belong together: the volumes are known from how the meshes are made. */
#include "repair_test.h"

#include <math.h>

enum { AROUND = 40 };

/** The part of a circle's area that a polygon of so many corners has. */
static double polygon_part(int corners) {
  return corners / (2 * M_PI) * sin(2 * M_PI / corners);
}

/** Turns a profile of radii and heights about the axis through (x, 0); its faces look to its right, inward
 * if they are reversed. Of several at one place each has vertices of its own. */
static void add_turned(vxm_soup *soup, const double (*profile)[2], uint32_t count, uint32_t around, double x,
                       bool reversed) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t i = 0; i < around; i++)
    for (uint32_t k = 0; k < count; k++) {
      double angle = 2 * M_PI * i / around;
      add_vertex(soup, x + profile[k][0] * cos(angle), profile[k][0] * sin(angle), profile[k][1]);
    }
  for (uint32_t i = 0; i < around; i++)
    for (uint32_t k = 0; k + 1 < count; k++) {
      uint32_t a = first + i * count + k, b = first + (i + 1) % around * count + k;
      uint32_t quad[2][3] = {{a, b, b + 1}, {a, b + 1, a + 1}};
      for (int t = 0; t < 2; t++)
        if (profile[k + (t == 0 ? 0 : 1)][0] > 0)
          add_triangle(soup, quad[t][0], quad[t][reversed ? 2 : 1], quad[t][reversed ? 1 : 2]);
    }
}

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

/* ---- Two walls ---- */

/** Closed with a band the whole has no lid: its area is known as well. */
static void check_band(vxm_soup *soup, double volume, double strip) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  REPAIR_REPORT(report);
  vxm_soup_destroy(repaired(soup, &options, &report));
  assert_true(fabs(report.after->area - report.before->area - strip) < 1e-9);
  assert_int_equal(report.filled_holes, 2);
  assert_int_equal(count_of(&report, "apart"), 0);
  check_closed(soup, 1, volume, 1e-9);
}

static void cups_and_tubes_get_a_rim(void **state) {
  double disc = M_PI * polygon_part(AROUND);
  vxm_soup *cup = new_soup(*state);
  add_turned(cup, (const double[][2]){{0, 0}, {1, 0}, {1, 2}}, 3, AROUND, 0, false);
  add_turned(cup, (const double[][2]){{0, 0.1}, {0.9, 0.1}, {0.9, 2}}, 3, AROUND, 0, true);
  check_band(cup, disc * (2 - 0.81 * 1.9), disc * (1 - 0.81));
  for (int thick = 0; thick < 2; thick++) {
    double r = thick ? 0.3 : 0.9;
    vxm_soup *tube = new_soup(*state);
    add_turned(tube, (const double[][2]){{1, 0}, {1, 2}, {r, 2}, {r, 0}}, 4, AROUND, 0, false);
    check_band(tube, 2 * disc * (1 - r * r), disc * (1 - r * r));
  }
}

/** Walls of other meshes, and one that ends a little below the other. */
static void rims_need_not_be_alike(void **state) {
  enum { INNER = 27 };
  double outer = M_PI * polygon_part(AROUND), inner = 0.64 * M_PI * polygon_part(INNER);
  vxm_soup *cup = new_soup(*state);
  add_turned(cup, (const double[][2]){{0, 0}, {1, 0}, {1, 2}}, 3, AROUND, 0, false);
  add_turned(cup, (const double[][2]){{0, 0.1}, {0.8, 0.1}, {0.8, 2}}, 3, INNER, 0, true);
  check_closed(cup, 1, 2 * outer - 1.9 * inner, 1e-9);
  vxm_soup *slanted = new_soup(*state);
  add_turned(slanted, (const double[][2]){{0, 0}, {1, 0}, {1, 2}}, 3, AROUND, 0, false);
  add_turned(slanted, (const double[][2]){{0, 0.1}, {0.8, 0.1}, {0.8, 1.9}}, 3, AROUND, 0, true);
  /* the frustum between the two rims is not of the cup */
  double frustum = 0.1 / 3 * (1 + 0.8 + 0.64);
  check_closed(slanted, 1, M_PI * polygon_part(AROUND) * (2 - frustum - 0.64 * 1.8), 1e-9);
}

/** Rims that lie along each other, too, but each is to be closed for itself. */
static void bodies_stay_apart(void **state) {
  double disc = M_PI * polygon_part(AROUND);
  vxm_soup *cups = new_soup(*state); /* one in the other, both to be filled */
  add_turned(cups, (const double[][2]){{0, 0}, {1, 0}, {1, 2}}, 3, AROUND, 0, false);
  add_turned(cups, (const double[][2]){{0, 0.1}, {0.9, 0.1}, {0.9, 2}}, 3, AROUND, 0, false);
  check_closed(cups, 2, disc * (2 + 0.81 * 1.9), 1e-4);
  vxm_soup *pipes = new_soup(*state);
  add_turned(pipes, (const double[][2]){{1, 0}, {1, 2}}, 2, AROUND, 0, false);
  add_turned(pipes, (const double[][2]){{0.9, 0}, {0.9, 2}}, 2, AROUND, 0, false);
  check_closed(pipes, 2, disc * (2 + 0.81 * 2), 1e-4);
  vxm_soup *gap = new_soup(*state); /* two pipes with their ends to each other */
  add_turned(gap, (const double[][2]){{1, 0}, {1, 2}}, 2, AROUND, 0, false);
  add_turned(gap, (const double[][2]){{0.95, 2.01}, {0.95, 4}}, 2, AROUND, 0, false);
  check_closed(gap, 2, disc * (2 + 0.9025 * 1.99), 1e-9);
  vxm_soup *cover = new_soup(*state); /* a dome within the rim of a box, in its plane */
  add_turned(cover, (const double[][2]){{0, 0}, {1, 0}, {1, 2}}, 3, AROUND, 0, false);
  add_turned(cover, (const double[][2]){{0.9, 2}, {0.9, 3}, {0, 3}}, 3, AROUND, 0, false);
  check_closed(cover, 2, disc * (2 + 0.81), 1e-4);
}

/** A tray with a hole in its floor: upper rim and hole face away from each other, but are no two walls. And a
 * lining that ends far below the rim. */
static void planes_stay_apart(void **state) {
  double disc = M_PI * polygon_part(AROUND);
  vxm_soup *lining = new_soup(*state);
  add_turned(lining, (const double[][2]){{0, 0}, {1, 0}, {1, 2}}, 3, AROUND, 0, false);
  add_turned(lining, (const double[][2]){{0, 0.1}, {0.9, 0.1}, {0.9, 1.7}}, 3, AROUND, 0, true);
  check_closed(lining, 2, disc * (2 - 0.81 * 1.6), 1e-9);
  vxm_soup *tray = new_soup(*state);
  add_turned(tray, (const double[][2]){{0.3, 0}, {1, 0}, {1, 0.39}}, 3, AROUND, 0, false);
  check_closed(tray, 1, 0.39 * disc, 1e-9);
  vxm_soup *shaft = new_soup(*state); /* a narrow one, that ends below */
  add_turned(shaft, (const double[][2]){{0.3, 1.7}, {0.3, 0}, {1, 0}, {1, 2}}, 4, AROUND, 0, false);
  check_closed(shaft, 1, disc * (2 - 0.09 * 1.7), 1e-9);
  vxm_soup *plate = new_soup(*state);
  add_turned(plate, (const double[][2]){{0.8, 0}, {1, 0}}, 2, AROUND, 0, false);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.fill_holes = -1;
  REPAIR_REPORT(report);
  vxm_soup_destroy(repaired(plate, &options, &report));
  assert_int_equal(count_of(&report, "closing"), 0);
  assert_int_equal(report.open_parts, 1);
  vxm_soup_destroy(plate);
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
      cmocka_unit_test(cups_and_tubes_get_a_rim),
      cmocka_unit_test(rims_need_not_be_alike),
      cmocka_unit_test(bodies_stay_apart),
      cmocka_unit_test(planes_stay_apart),
      cmocka_unit_test(walls_within_leave_the_floor_whole),
      cmocka_unit_test(slits_at_a_rim_are_cut_off),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
