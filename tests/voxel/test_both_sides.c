/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Bodies that are drawn from both sides, in whole or in part, with polygons cut along other diagonals on each
 * side: they are what they are drawn from one side. Bodies are of unit cells, so their solid is known.
 */
#include "cells.h"

#include "../repair/repair_test.h"

/** A body of one or two boxes. */
static body random_body(vxm_rng *rng) {
  body b = {.copies = 1};
  add_random_box(&b, rng);
  if (vxm_rng_below(rng, 2) == 0)
    add_random_box(&b, rng);
  return b;
}

static int64_t count_cells(const body *b) {
  int64_t count = 0;
  for (size_t c = 0; c < CELLS; c++)
    count += b->cells[c];
  return count;
}

static void assert_volume(const vxm_soup *soup, double wanted, const char *what, uint64_t seed) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, &options, &report);
  if (!(fabs(report.after->volume - wanted) <= 1e-4 * wanted))
    fail_msg("%s, seed %llu: a volume of %g instead of %g", what, (unsigned long long)seed,
             report.after->volume, wanted);
  vxm_soup_destroy(out);
}

static void assert_as_once(vxm_context *context, uint64_t seed, uint64_t part, bool inward) {
  vxm_rng rng = {seed};
  manner how = squares;
  how.triangles = true;
  body b = random_body(&rng);
  vxm_soup *soup = new_soup(context), *prepared;
  add_body(soup, &b, &how, &rng);
  add_squares(soup, &b, &how, &rng, part, inward);
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, &how, b.cells);
  if (wrong > 0)
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  if (inward) /* else a part of it may be there twice, and its volume counts twice */
    assert_volume(soup, (double)count_cells(&b), "cells", seed);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

static void both_sides(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(300); seed++)
    assert_as_once(*state, seed, 0, true);
}

/** The others look either all in or all out. */
static void some_faces_twice(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(300); seed++)
    assert_as_once(*state, seed, 2 + seed % 4, seed % 2 == 0);
}

/** In these the squares are plane but for rounding. */
static void both_sides_in_any_direction(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(100); seed++) {
    vxm_rng rng = {~seed};
    double angle[2] = {7 * vxm_rng_unit(&rng), 7 * vxm_rng_unit(&rng)};
    double c = cos(angle[0]), s = sin(angle[0]), d = cos(angle[1]), t = sin(angle[1]);
    manner how = {.turn = {{c, -s * d, s * t}, {s, c * d, -c * t}, {0, t, d}}, .triangles = true, .unit = 1};
    body b = random_body(&rng);
    vxm_soup *soup = new_soup(*state);
    add_body(soup, &b, &how, &rng);
    add_squares(soup, &b, &how, &rng, 0, true);
    assert_volume(soup, (double)count_cells(&b), "turned cells", seed);
    vxm_soup_destroy(soup);
  }
}

/* ---- Polygons with more corners ---- */

/** A fan of a polygon about its corner `apex`. */
static void add_fan(vxm_soup *soup, const uint32_t *corners, uint32_t count, uint32_t apex) {
  for (uint32_t i = 1; i + 1 < count; i++)
    add_triangle(soup, corners[apex % count], corners[(apex + i) % count], corners[(apex + i + 1) % count]);
}

/** The sides of a prism of height 1 over a regular polygon, outward or inward, each a fan about some corner.
 */
static void add_prism(vxm_soup *soup, uint32_t n, bool inward, vxm_rng *rng) {
  uint32_t face[12];
  for (uint32_t side = 0; side < n + 2; side++) {
    uint32_t count = side < n ? 4 : n, next = (side + 1) % n;
    const uint32_t wall[4] = {2 * side, 2 * next, 2 * next + 1, 2 * side + 1};
    for (uint32_t i = 0; i < count; i++) {
      uint32_t corner = side < n ? wall[i] : side == n ? 2 * (n - 1 - i) : 2 * i + 1;
      face[inward ? count - 1 - i : i] = corner;
    }
    add_fan(soup, face, count, (uint32_t)vxm_rng_below(rng, count));
  }
}

static void prisms_from_both_sides(void **state) {
  vxm_rng rng = {5};
  for (uint32_t n = 3; n <= 12; n++)
    for (int round = 0; round < 20; round++) {
      vxm_soup *soup = new_soup(*state);
      for (uint32_t i = 0; i < 2 * n; i++) {
        double angle = 6.283185307179586 * (i / 2) / n;
        add_vertex(soup, cos(angle), sin(angle), i % 2);
      }
      add_prism(soup, n, false, &rng);
      add_prism(soup, n, true, &rng);
      assert_volume(soup, 0.5 * n * sin(6.283185307179586 / n), "prism", n);
      vxm_soup_destroy(soup);
    }
}

/* ---- What stays ---- */

/** Tetrahedra that hang together by edges alone are bodies, though two pairs of the faces of each have the
 * same border. */
static void tetrahedra_stay(void **state) {
  static const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  static const double points[][3] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
  vxm_soup *soup = new_soup(*state);
  for (int i = 0; i < 4; i++) /* of each cell of a checkerboard: neighbours share an edge */
    for (int v = 0; v < 4; v++) {
      double x = points[v][0], y = points[v][1];
      add_vertex(soup, i % 2 ? 2 - x : x, i / 2 ? 2 - y : y, points[v][2]);
    }
  for (uint32_t i = 0; i < 4; i++)
    for (int f = 0; f < 4; f++) {
      bool mirrored = i == 1 || i == 2;
      add_triangle(soup, 4 * i + (uint32_t)face[f][0], 4 * i + (uint32_t)face[f][mirrored ? 2 : 1],
                   4 * i + (uint32_t)face[f][mirrored ? 1 : 2]);
    }
  assert_volume(soup, 4.0 / 3, "tetrahedra", 0);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(both_sides), cmocka_unit_test(some_faces_twice),
                                     cmocka_unit_test(both_sides_in_any_direction),
                                     cmocka_unit_test(prisms_from_both_sides),
                                     cmocka_unit_test(tetrahedra_stay)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
