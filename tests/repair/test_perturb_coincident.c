/* SPDX-License-Identifier: BSD-3-Clause */
/** Bodies that touch are moved apart so little that their volumes stay, in doubles and in 32-bit floats, near
 * the origin and far from it. */
#include "repair_test.h"

#include "mesh/part_census.h"
#include "repair/verify.h"

#include <float.h>
#include <math.h>

/** A box of six quads from `low` to `high`. */
static void add_box(vxm_soup *soup, const double low[3], const double high[3]) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < 8; v++)
    add_vertex(soup, v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
  for (int f = 0; f < 6; f++) {
    uint32_t corners[4];
    for (int i = 0; i < 4; i++)
      corners[i] = first + faces[f][i];
    add_face(soup, corners, 4);
  }
}

/** Boxes in a row that touch at corners, or along edges of the axis `along` (3 = none). */
static vxm_soup *row_of_boxes(vxm_context *context, const double origin[3], const double size[3], int count,
                              int along) {
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < count; i++) {
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = origin[a] + (a == along ? 0 : i * size[a]);
      high[a] = origin[a] + (a == along ? 1 : i + 1) * size[a];
    }
    add_box(soup, low, high);
  }
  return soup;
}

static vxm_verification verified(const vxm_soup *soup, const vxm_repair_options *options) {
  vxm_verification found = VXM_VERIFICATION_INIT;
  assert_int_equal(vxm_verify(&found, soup, options, NULL), VXM_OK);
  return found;
}

/** How far a vertex may be moved: by three times what tells it from others, along each axis, which is four
 * units in the last place of a float in which the largest coordinate is held, or five of the grid of 1e-8. */
static double most_displacement(const vxm_part_state *state) {
  double most = 0;
  for (int i = 0; i < 6; i++)
    most = fmax(most, fabs(state->bounds[i]));
  return 3 * sqrt(3.0) * fmax(4 * most * (double)FLT_EPSILON, 5e-8);
}

static void boxes_keep_volume(void **state) {
  static const double far[] = {0, 1, 100, 1e4, 1e6};
  vxm_rng rng = {21};
  int refused = 0;
  for (int trial = 0; trial < 600; trial++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    double origin[3], size[3];
    int count = 2 + (int)vxm_rng_below(&rng, 4);
    options.level = trial % 3 ? VXM_LEVEL_MANIFOLD : VXM_LEVEL_CLOSED;
    options.single_precision = trial % 2;
    options.part_changes = true;
    for (int a = 0; a < 3; a++) {
      origin[a] = far[vxm_rng_below(&rng, 5)] * (vxm_rng_below(&rng, 2) ? 1 : -1);
      size[a] = ldexp(1, (int)vxm_rng_below(&rng, 8) - 4); /* which floats hold */
    }
    vxm_soup *soup = row_of_boxes(*state, origin, size, count, (int)vxm_rng_below(&rng, 4));
    for (size_t i = 0; i < 3 * soup->vertex_count; i++)
      if (options.single_precision)
        soup->positions[i] = (double)(float)soup->positions[i];
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, &options, &report);
    vxm_verification found = verified(out, &options);
    assert_int_equal(found.reached, report.unparted_vertices == 0 && out->face_count > 0);
    refused += report.unparted_vertices > 0;
    if (found.reached && report.before->degenerate_faces == 0) {
      double want = count * size[0] * size[1] * size[2];
      const vxm_part_state *one = out->part_changes[0].after;
      assert_int_equal(out->part_count, 1);
      assert_int_equal(report.after->components, report.before->components_raw);
      double moved = out->part_changes[0].max_displacement;
      if (moved > most_displacement(one))
        fail_msg("trial %d: moved by %g", trial, moved);
      if (fabs(one->volume - want) > 1e-9 * want + one->area * moved)
        fail_msg("trial %d: volume %.17g, not %.17g", trial, one->volume, want);
    }
    if (found.reached)
      assert_repair_is_done(out, &options);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  assert_true(refused > 0 && refused < 300);
}

/** Two unit cubes that share an edge at 1e6, where floats are 1/16 apart. */
static void far_from_the_origin(void **state) {
  static const double size[3] = {1, 1, 1}, at_ground[3] = {1e6, 1e6, 0}, far[3] = {1e6, 1e6, 1e6};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  REPAIR_REPORT(report);
  options.level = VXM_LEVEL_MANIFOLD;
  options.single_precision = true;
  /* along z there is room */
  vxm_soup *soup = row_of_boxes(*state, at_ground, size, 2, 2), *out = repaired(soup, &options, &report);
  assert_true(verified(out, &options).reached);
  assert_int_equal(report.unparted_vertices, 0);
  assert_true(fabs(report.after->volume - 2) < 3e-6);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  /* there is none: the vertices stay, and that is told */
  soup = row_of_boxes(*state, far, size, 2, 2);
  out = repaired(soup, &options, &report);
  vxm_verification found = verified(out, &options);
  assert_false(found.reached);
  assert_string_equal(found.findings[0].what, "nonmanifold_edges");
  assert_int_equal(report.unparted_vertices, 4);
  assert_true(report.after->volume == 2);
  vxm_soup_destroy(out);
  /* doubles tell them apart */
  options.single_precision = false;
  out = repaired(soup, &options, &report);
  assert_true(verified(out, &options).reached);
  assert_true(fabs(report.after->volume - 2) < 3e-6);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** A part that is small beside the model loses no more of its volume than telling its vertices apart takes.
 */
static void small_beside_the_model(void **state) {
  static const double low[3] = {0, 0, 0}, high[3] = {1000, 1000, 1000}, size[3] = {1e-3, 1e-3, 1e-3};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_MANIFOLD;
  options.part_changes = true;
  vxm_soup *soup = row_of_boxes(*state, (const double[3]){2000, 0, 0}, size, 2, 2);
  add_box(soup, low, high);
  vxm_soup *out = repaired(soup, &options, NULL);
  assert_true(verified(out, &options).reached);
  assert_true(fabs(out->part_changes[0].after->volume / 2e-9 - 1) < 1e-3);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** How many vertices are one with an earlier one to a program that rounds to 1e-8, or to 32-bit floats. */
static int count_merging(const vxm_soup *soup, bool floats) {
  int count = 0;
  for (size_t v = 0; v < soup->vertex_count; v++)
    for (size_t w = 0; w < v; w++) {
      const double *p = vxm_position(soup, v), *q = vxm_position(soup, w);
      bool same = true;
      for (int a = 0; a < 3; a++)
        same = same && (floats ? (float)p[a] == (float)q[a] : rint(p[a] * 1e8) == rint(q[a] * 1e8));
      if (same) {
        count++;
        break;
      }
    }
  return count;
}

/** Others do not merge what was moved apart, at whatever scale. */
static void others_tell_them_apart(void **state) {
  vxm_rng rng = {22};
  for (int trial = 0; trial < 300; trial++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    double origin[3], size[3], scale = pow(10, vxm_rng_unit(&rng) * 6 - 2);
    options.level = VXM_LEVEL_CLOSED;
    options.single_precision = trial % 3 == 0;
    options.triangles = trial % 2;
    for (int a = 0; a < 3; a++) {
      origin[a] = scale * (vxm_rng_unit(&rng) - 0.5) * 10;
      size[a] = scale * (0.1 + vxm_rng_unit(&rng));
    }
    vxm_soup *soup = row_of_boxes(*state, origin, size, 3, (int)vxm_rng_below(&rng, 4));
    vxm_soup *out = repaired(soup, &options, NULL);
    assert_true(verified(out, &options).reached);
    assert_int_equal(out->vertex_count, 24);
    if (count_merging(out, false) > 0 || count_merging(out, true) > 0)
      fail_msg("trial %d: %d merge after rounding, %d as floats", trial, count_merging(out, false),
               count_merging(out, true));
    assert_repair_is_done(out, &options);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** Vertices that lie apart, but so near that others merge them: of two boxes with a gap between them, and of
 * one that has an edge as short. In a model that is itself small they stay. */
static void near_vertices(void **state) {
  for (int trial = 0; trial < 4; trial++) {
    const double scale = trial < 2 ? 1 : 1e-5, gap = 2e-9;
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    REPAIR_REPORT(report);
    options.level = VXM_LEVEL_CLOSED;
    options.weld = VXM_WELD_OFF;
    options.triangles = true;
    vxm_soup *soup = new_soup(*state);
    add_box(soup, (const double[3]){0, 0, 0}, (const double[3]){scale, scale, scale});
    if (trial % 2)
      add_box(soup, (const double[3]){scale + gap, 0, 0}, (const double[3]){2 * scale, scale, scale});
    else /* a corner of the box is drawn out along an edge */
      for (int a = 0; a < 3; a++)
        soup->positions[3 * 7 + a] = soup->positions[3 * 3 + a] + (a == 2 ? gap : 0);
    vxm_verification found = verified(soup, &options);
    assert_int_equal(found.reached, trial >= 2);
    if (trial < 2) {
      assert_string_equal(found.findings[0].what, "near_vertices");
      assert_int_equal(found.findings[0].count, trial % 2 ? 4 : 1);
    }
    vxm_soup *out = repaired(soup, &options, &report);
    assert_true(verified(out, &options).reached);
    assert_int_equal(report.unparted_vertices, 0);
    assert_int_equal(out->vertex_count, soup->vertex_count);
    assert_int_equal(count_merging(out, false) > 0, trial >= 2);
    assert_repair_is_done(out, &options);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** Boxes with a gap that doubles hold and 32-bit floats do not: they come apart by a unit of these or some.
 * Far from the origin, where that would deform them, they stay, and the level is reached all the same. */
static void gaps_below_floats(void **state) {
  vxm_rng rng = {23};
  for (int trial = 0; trial < 100; trial++) {
    const bool far = trial % 4 == 3;
    const double at = (far ? 1e6 : 10 + 90 * vxm_rng_unit(&rng)), size = far ? 0.01 : 1;
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    REPAIR_REPORT(report);
    options.level = trial % 2 ? VXM_LEVEL_MANIFOLD : VXM_LEVEL_CLOSED;
    options.weld = VXM_WELD_OFF;
    options.part_changes = true;
    double start = (double)(float)at, gap = 1e-7;
    vxm_soup *soup = new_soup(*state);
    add_box(soup, (const double[3]){start - size, at, at}, (const double[3]){start, at + size, at + size});
    add_box(soup, (const double[3]){start + gap, at, at},
            (const double[3]){start + size, at + size, at + size});
    assert_true(count_merging(soup, true) >= 4);
    vxm_soup *out = repaired(soup, &options, &report);
    assert_true(verified(out, &options).reached);
    assert_int_equal(report.unparted_vertices, 0);
    assert_int_equal(count_merging(out, true) > 0, far);
    assert_true(report.max_displacement <= 3 * sqrt(3.0) * 4 * (at + size) * (double)FLT_EPSILON);
    assert_int_equal(report.max_displacement > 0, !far);
    assert_repair_is_done(out, &options);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static int set_up(void **state) {
  *state = context_of_threads(2);
  return 0;
}

static int tear_down(void **state) {
  vxm_context_destroy(*state);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_keep_volume),      cmocka_unit_test(far_from_the_origin),
      cmocka_unit_test(small_beside_the_model), cmocka_unit_test(others_tell_them_apart),
      cmocka_unit_test(near_vertices),          cmocka_unit_test(gaps_below_floats),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
