/* SPDX-License-Identifier: BSD-3-Clause */
/** Tolerant welding of meshes that were torn apart. */
#include "repair_test.h"

#include <math.h>

/** A sphere of n rings; closed. */
static vxm_soup *sphere(vxm_context *context, size_t n) {
  vxm_soup *soup = new_soup(context);
  size_t around = 2 * n;
  for (size_t i = 0; i <= n; i++)
    for (size_t j = 0; j < around && (j == 0 || (i > 0 && i < n)); j++) {
      double polar = M_PI * (double)i / (double)n, turn = M_PI * (double)j / (double)n;
      add_vertex(soup, sin(polar) * cos(turn), sin(polar) * sin(turn), cos(polar));
    }
  uint32_t last = (uint32_t)soup->vertex_count - 1;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < around; j++) {
      uint32_t ring = (uint32_t)(1 + (i - 1) * around), k = (uint32_t)((j + 1) % around),
               a = ring + (uint32_t)j;
      uint32_t b = ring + k, below = (uint32_t)around;
      if (i == 0)
        add_triangle(soup, 0, 1 + (uint32_t)j, 1 + k);
      else if (i == n - 1)
        add_triangle(soup, a, last, b);
      else {
        add_triangle(soup, a, a + below, b + below);
        add_triangle(soup, a, b + below, b);
      }
    }
  return soup;
}

/** Every triangle on its own vertices, each moved by up to `jitter` along each axis. */
static vxm_soup *torn(const vxm_soup *soup, double jitter) {
  vxm_soup *out = new_soup(soup->context);
  vxm_rng rng = {1};
  for (size_t f = 0; f < soup->face_count; f++) {
    uint32_t corners[3];
    for (size_t i = 0; i < 3; i++) {
      const double *p = vxm_position(soup, soup->indices[3 * f + i]);
      corners[i] = (uint32_t)out->vertex_count;
      add_vertex(out, p[0] + jitter * vxm_rng_unit(&rng), p[1] + jitter * vxm_rng_unit(&rng),
                 p[2] + jitter * vxm_rng_unit(&rng));
    }
    add_face(out, corners, 3);
  }
  tag_faces(out);
  return out;
}

/** No two corners that became one vertex were farther apart than so much. */
static void check_distances(const vxm_soup *in, const vxm_soup *out, double most) {
  /* corners by the vertex they became: at most a handful each */
  size_t *first = malloc(out->vertex_count * sizeof *first), *next = malloc(in->corner_count * sizeof *next);
  assert_non_null(first);
  assert_non_null(next);
  for (size_t v = 0; v < out->vertex_count; v++)
    first[v] = SIZE_MAX;
  for (size_t f = 0; f < out->face_count; f++)
    for (size_t i = 0; i < 3; i++) {
      size_t corner = 3 * (size_t)out->face_tags[f] + i;
      uint32_t v = out->indices[3 * f + i];
      const double *p = vxm_position(in, in->indices[corner]);
      for (size_t other = first[v]; other != SIZE_MAX; other = next[other])
        assert_true(distance_between(p, vxm_position(in, in->indices[other])) <= most * (1 + 1e-12));
      next[corner] = first[v];
      first[v] = corner;
    }
  free(first);
  free(next);
}

static void torn_sphere_closes(void **state) {
  vxm_soup *whole = sphere(*state, 24);
  static const double jitters[] = {1e-9, 1e-7, 1e-6};
  for (size_t i = 0; i < sizeof jitters / sizeof *jitters; i++)
    for (int given = 0; given < 2; given++) {
      vxm_soup *soup = torn(whole, jitters[i]);
      vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
      options.weld = given ? VXM_WELD_TOLERANCE : VXM_WELD_AUTO;
      options.weld_tolerance = 2 * jitters[i];
      REPAIR_REPORT(report);
      vxm_soup *out = repaired(soup, &options, &report);
      assert_int_equal(report.before->boundary_edges, 3 * whole->face_count);
      assert_true(report.after->watertight && report.after->closed);
      assert_int_equal(report.after->components, 1);
      assert_int_equal(out->vertex_count, whole->vertex_count);
      assert_int_equal(out->face_count, whole->face_count);
      assert_int_equal(count_of(&report, "tolerant_weld"), soup->vertex_count - whole->vertex_count);
      check_distances(soup, out, 2 * jitters[i]);
      assert_repair_is_done(out, &options);
      vxm_soup_destroy(out);
      options.weld = VXM_WELD_OFF;
      out = repaired(soup, &options, &report);
      assert_int_equal(report.after->boundary_edges, 3 * whole->face_count);
      vxm_soup_destroy(out);
      vxm_soup_destroy(soup);
    }
  vxm_soup_destroy(whole);
}

/** What counts as a crack goes with the size of the model. */
static void any_size_of_model(void **state) {
  vxm_soup *whole = sphere(*state, 12);
  static const double sizes[] = {1e-6, 1e6, 1e-150, 1e150};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    for (int wide = 0; wide < 2; wide++) {
      vxm_soup *soup = torn(whole, wide ? 5e-3 : 1e-7);
      for (size_t c = 0; c < 3 * soup->vertex_count; c++)
        soup->positions[c] *= sizes[i];
      REPAIR_REPORT(report);
      vxm_soup *out = repaired(soup, NULL, &report);
      assert_int_equal(report.after->watertight, !wide);
      assert_repair_is_done(out, NULL);
      vxm_soup_destroy(out);
      vxm_soup_destroy(soup);
    }
  vxm_soup_destroy(whole);
}

/** A jitter about as wide as the tolerance: of groups that are wider some vertices stay; no two within it,
 * none that was farther away than that, and here the fewer the wider it is. */
static void jitter_as_wide_as_the_tolerance(void **state) {
  vxm_soup *whole = sphere(*state, 16);
  int64_t before = 0;
  for (int step = 1; step <= 12; step++) {
    vxm_soup *soup = torn(whole, 0.01);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.weld = VXM_WELD_TOLERANCE;
    options.weld_tolerance = 0.0015 * step;
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, &options, &report);
    check_distances(soup, out, 2 * options.weld_tolerance);
    for (size_t v = 0; v < out->vertex_count; v++)
      for (size_t u = 0; u < v; u++)
        assert_true(distance_between(vxm_position(out, u), vxm_position(out, v)) > options.weld_tolerance);
    assert_repair_is_done(out, &options);
    assert_int_equal(out->face_count, whole->face_count);
    assert_true(count_of(&report, "tolerant_weld") >= before);
    before = count_of(&report, "tolerant_weld");
    assert_true(step > 1 || !report.after->watertight);
    assert_true(step < 12 || report.after->watertight);
    vxm_soup_destroy(out);
    /* far wider than what can come from rounding: nothing is done without being asked */
    out = repaired(soup, NULL, &report);
    assert_int_equal(count_of(&report, "tolerant_weld"), 0);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  vxm_soup_destroy(whole);
}

/** Two quadrilaterals side by side, with a gap between their facing edges. */
static vxm_soup *two_panels(vxm_context *context, double gap) {
  double x = 1 + gap;
  const double positions[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {x, 0, 0}, {2, 0, 0}, {2, 1, 0}, {x, 1, 0}};
  static const int faces[] = {0, 1, 2, 3, -1, 4, 5, 6, 7, -1};
  return soup_of(context, positions, 8, faces, 2);
}

static int64_t auto_merges(vxm_soup *soup) {
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_repair_is_done(out, NULL);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  return count_of(&report, "tolerant_weld");
}

static void only_what_closes(void **state) {
  assert_int_equal(auto_merges(two_panels(*state, 1e-7)), 2);
  assert_int_equal(auto_merges(two_panels(*state, 1e-4)), 0);

  /* touching in one corner only closes nothing */
  vxm_soup *soup = two_panels(*state, 1e-7);
  soup->positions[3 * 7 + 1] = 3;
  assert_int_equal(auto_merges(soup), 0);

  /* the end of an edge that is as short as the gap stays where it is */
  soup = two_panels(*state, 1e-7);
  add_vertex(soup, 1 + 1e-6, 0, 0);
  soup->indices[4] = 4;
  uint32_t sliver[3] = {4, 8, 7};
  add_face(soup, sliver, 3);
  assert_int_equal(auto_merges(soup), 0);

  /* a third mesh with a vertex in the crack, closed by itself, is not drawn in */
  soup = two_panels(*state, 1e-7);
  uint32_t first = (uint32_t)soup->vertex_count;
  add_vertex(soup, 1 + 5e-8, 0, 0);
  add_vertex(soup, 1, -1, 0);
  add_vertex(soup, 2, -1, 0);
  add_vertex(soup, 1, -1, 1);
  static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (int f = 0; f < 4; f++)
    add_triangle(soup, first + faces[f][0], first + faces[f][1], first + faces[f][2]);
  assert_int_equal(auto_merges(soup), 0);
}

/** Doubled faces hide a crack: every edge along it has two sides until the doubles are gone. */
static void cracks_under_doubled_faces(void **state) {
  vxm_soup *soup = two_panels(*state, 1e-7);
  add_face(soup, (uint32_t[]){3, 2, 1, 0}, 4);
  add_face(soup, (uint32_t[]){7, 6, 5, 4}, 4);
  assert_int_equal(auto_merges(soup), 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(torn_sphere_closes),
      cmocka_unit_test(any_size_of_model),
      cmocka_unit_test(jitter_as_wide_as_the_tolerance),
      cmocka_unit_test(only_what_closes),
      cmocka_unit_test(cracks_under_doubled_faces),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
