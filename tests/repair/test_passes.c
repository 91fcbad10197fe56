/* SPDX-License-Identifier: BSD-3-Clause */
/** Every pass alone, on soups small enough to see what must come out. */
#include "repair_test.h"

#include <math.h>

static const double corners_of_square[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};

/** A pyramid with a square base, closed: 5 vertices, 5 faces. */
static const int pyramid[] = {3, 2, 1, 0, -1, 0, 1, 4, -1, 1, 2, 4, -1, 2, 3, 4, -1, 3, 0, 4, -1};

static vxm_soup *new_pyramid(vxm_context *context) {
  return soup_of(context, corners_of_square, 5, pyramid, 5);
}

static void clean_mesh_stays(void **state) {
  vxm_soup *soup = new_pyramid(*state);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(count_all(&report), 0);
  assert_same_soup(soup, out);
  assert_true(report.before->watertight && report.after->watertight);
  static const char *const names[] = {"rounding",
                                      "nonfinite_vertices",
                                      "exact_weld",
                                      "tolerant_weld",
                                      "repeated_corners",
                                      "zero_area_faces",
                                      "t_junctions",
                                      "duplicate_faces",
                                      "opposite_duplicate_faces",
                                      "inner_walls",
                                      "orientation",
                                      "wrap",
                                      "separation",
                                      "closing",
                                      "small_parts",
                                      "sheets",
                                      "union",
                                      "apart",
                                      "unused_vertices"};
  assert_int_equal(report.pass_count, sizeof names / sizeof *names);
  for (int i = 0; i < report.pass_count; i++)
    assert_string_equal(report.passes[i].pass, names[i]);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void nonfinite(void **state) {
  vxm_soup *soup = new_pyramid(*state), *clean = new_pyramid(*state);
  add_vertex(soup, NAN, 0, 0);
  add_vertex(soup, 0, INFINITY, 0);
  add_vertex(soup, 0, INFINITY, 0);
  add_triangle(soup, 0, 1, 5);
  add_triangle(soup, 6, 1, 2);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "nonfinite_vertices"), 3);
  assert_int_equal(count_all(&report), 3);
  assert_same_soup(out, clean);
  vxm_soup_destroy(out);
  vxm_soup_destroy(clean);
  vxm_soup_destroy(soup);
}

static void exact_weld(void **state) {
  vxm_soup *soup = new_soup(*state), *clean = new_pyramid(*state);
  size_t begin = 0;
  for (int face = 0; face < 5; face++) {
    uint32_t corners[4];
    size_t count = 0;
    for (; pyramid[begin] >= 0; begin++) {
      const double *p = corners_of_square[pyramid[begin]];
      corners[count++] = (uint32_t)soup->vertex_count;
      add_vertex(soup, p[0] == 0 ? (face % 2 ? -0.0 : 0.0) : p[0], p[1], p[2]);
    }
    begin++;
    add_face(soup, corners, count);
  }
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "exact_weld"), 16 - 5);
  assert_int_equal(count_all(&report), 16 - 5);
  assert_int_equal(out->vertex_count, 5);
  assert_true(report.before->watertight && report.after->watertight);
  assert_int_equal(report.before->components_raw, 5);
  assert_int_equal(report.after->components_raw, 1);
  /* the base came first, so its corners are the first vertices */
  static const double first[4][3] = {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 0}};
  assert_memory_equal(out->positions, first, sizeof first);
  vxm_soup_destroy(out);
  vxm_soup_destroy(clean);
  vxm_soup_destroy(soup);
}

/** The reduced form of one face, as a text of digits. */
static void assert_reduces_to(vxm_context *context, const int *face, const char *wanted, int64_t count) {
  static const double positions[6][3] = {{0, 0, 0}, {1, 0, 0},  {1, 1, 0},
                                         {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0.5}};
  vxm_soup *soup = soup_of(context, positions, 6, face, 1);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  char text[64] = "";
  size_t n = 0;
  const uint32_t *corners = out->face_count ? vxm_face(out, 0, &n) : NULL;
  for (size_t i = 0; i < n; i++)
    for (int v = 0; v < 6; v++)
      if (memcmp(positions[v], vxm_position(out, corners[i]), sizeof positions[v]) == 0)
        text[i] = (char)('0' + v);
  assert_string_equal(text, wanted);
  assert_int_equal(count_of(&report, "repeated_corners"), count);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void repeated_corners(void **state) {
  assert_reduces_to(*state, (int[]){0, 1, 2, -1}, "012", 0);
  assert_reduces_to(*state, (int[]){0, 0, 1, 2, -1}, "012", 1);
  assert_reduces_to(*state, (int[]){0, 1, 2, 2, 2, 0, 0, -1}, "012", 1);
  assert_reduces_to(*state, (int[]){0, 1, 1, -1}, "", 1);
  assert_reduces_to(*state, (int[]){0, 1, 0, -1}, "", 1);
  assert_reduces_to(*state, (int[]){0, 1, -1}, "", 1);
  assert_reduces_to(*state, (int[]){3, -1}, "", 1);
  assert_reduces_to(*state, (int[]){-1}, "", 1);
  /* spikes, also around the end, and spikes on spikes */
  assert_reduces_to(*state, (int[]){0, 1, 2, 5, 2, 3, -1}, "0123", 1);
  assert_reduces_to(*state, (int[]){5, 2, 3, 0, 1, 2, -1}, "2301", 1);
  assert_reduces_to(*state, (int[]){2, 3, 0, 1, 2, 5, -1}, "2301", 1);
  assert_reduces_to(*state, (int[]){0, 1, 2, 3, 4, 5, 4, 3, 2, -1}, "012", 1);
  assert_reduces_to(*state, (int[]){0, 1, 2, 3, 4, 3, 2, 1, -1}, "", 1);
  assert_reduces_to(*state, (int[]){0, 1, 0, 1, 0, 1, -1}, "", 1);
  /* a polygon that touches itself, and one with a bridge to its hole, are as they should be */
  assert_reduces_to(*state, (int[]){0, 1, 2, 0, 3, 4, -1}, "012034", 0);
  assert_reduces_to(*state, (int[]){0, 1, 2, 0, 3, 4, 5, 3, -1}, "01203453", 0);
}

/** A sliver that fills the step between one long side and two short ones keeps the mesh closed. */
static void zero_area_faces_that_close(void **state) {
  static const double positions[6][3] = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0.5, 1}, {1, -1, 0}};
  /* tetrahedron 0 1 3 4 whose side 0-1 is cut at 2 in one face; the last triangle is the sliver */
  static const int faces[] = {0, 3, 1, -1, 1, 3, 4, -1, 3, 0, 4, -1, 0, 2, 4, -1, 2, 1, 4, -1, 0, 1, 2, -1};
  vxm_soup *soup = soup_of(*state, positions, 6, faces, 6);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_true(report.before->closed && report.after->closed);
  assert_int_equal(out->face_count, 6);
  assert_int_equal(count_of(&report, "zero_area_faces"), 0);
  assert_int_equal(report.after->degenerate_faces, 1);
  assert_int_equal(count_of(&report, "unused_vertices"), 1);
  vxm_soup_destroy(out);

  /* of it and its reverse one goes, and so do a sliver that hangs on it and one that stands alone */
  add_triangle(soup, 0, 2, 1);
  add_vertex(soup, 3, 0, 0);
  add_triangle(soup, 1, 2, 6);
  add_vertex(soup, 5, 5, 5);
  add_vertex(soup, 6, 6, 6);
  add_vertex(soup, 7, 7, 7);
  add_triangle(soup, 7, 8, 9);
  out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "zero_area_faces"), 3);
  assert_int_equal(count_of(&report, "opposite_duplicate_faces"), 0);
  assert_true(report.after->closed);
  assert_int_equal(out->face_count, 6);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** Fins and walls of what is closed go altogether, so that it stays closed; sheets keep one of two faces. */
static void fins(void **state) {
  REPAIR_REPORT(report);
  vxm_soup *soup = new_soup(*state);
  add_cube(soup, 0);
  add_vertex(soup, 0.5, -0.5, 0.5); /* a fin of two triangles back to back at the edge 0 1 */
  add_triangle(soup, 0, 1, 8);
  add_triangle(soup, 1, 0, 8);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "opposite_duplicate_faces"), 2);
  assert_true(report.after->closed && report.after->volume > 0.999999 && report.after->volume < 1.000001);
  assert_int_equal(out->face_count, 6);
  assert_repair_is_done(out, NULL);
  vxm_soup_destroy(out);
  /* as large as the body, it is a sheet that hangs on it */
  soup->positions[3 * 8 + 1] = -20;
  out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "opposite_duplicate_faces"), 1);
  assert_int_equal(out->face_count, 7);
  assert_repair_is_done(out, NULL);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  /* of what is open one stays, and of what is nothing else */
  for (int open = 0; open < 2; open++) {
    soup = new_soup(*state);
    for (int v = 0; v < 4; v++)
      add_vertex(soup, v & 1, v >> 1, 0);
    add_triangle(soup, 0, 1, 2);
    add_triangle(soup, 2, 1, 0);
    add_triangle(soup, 1, 3, 2);
    if (!open)
      add_triangle(soup, 2, 3, 1);
    out = repaired(soup, NULL, &report);
    assert_int_equal(out->face_count, 2);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  /* two bodies that overlap and share a part of their surfaces both keep it: a cube in the lower half of
   * another */
  soup = new_soup(*state);
  add_cube(soup, 0);
  add_cube(soup, 0);
  for (size_t v = 8; v < 16; v++)
    if (soup->positions[3 * v + 2] > 0)
      soup->positions[3 * v + 2] = 0.5;
  out = repaired(soup, NULL, &report);
  assert_int_equal(report.shared_faces, 1);
  assert_int_equal(out->face_count, 12);
  assert_true(report.after->closed && report.after->volume > 1.499999 && report.after->volume < 1.500001);
  assert_repair_is_done(out, NULL);
  vxm_soup_destroy(out);
  /* and for voxelizing each gets its own */
  assert_int_equal(vxm_repair_prepare(&out, &report, soup, NULL, NULL), VXM_OK);
  assert_int_equal(report.shared_faces, 0);
  assert_int_equal(report.after->components_raw, 2);
  assert_true(report.after->closed && report.after->volume > 1.499999 && report.after->volume < 1.500001);
  vxm_soup_destroy(out);
  vxm_repair_options as_turned = VXM_REPAIR_OPTIONS_INIT;
  as_turned.keep_orientation = true;
  assert_int_equal(vxm_repair_prepare(&out, &report, soup, &as_turned, NULL), VXM_OK);
  assert_int_equal(report.shared_faces, 1);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  /* two rooms that each have the wall between them become one */
  for (int same = 0; same < 2; same++) {
    soup = new_soup(*state);
    add_cube(soup, 0);
    add_cube(soup, 1);
    for (size_t c = 24; c < 48 && same; c += 4) { /* the second one inside out */
      uint32_t kept = soup->indices[c + 1];
      soup->indices[c + 1] = soup->indices[c + 3];
      soup->indices[c + 3] = kept;
    }
    out = repaired(soup, NULL, &report);
    assert_int_equal(out->face_count, 10);
    assert_true(report.after->watertight && report.after->volume > 1.999999 &&
                report.after->volume < 2.000001);
    assert_repair_is_done(out, NULL);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** A body that was drawn from both sides, and lies at another one with a face and an edge, on any of its
 * sides, is not a wall within that. */
static void bodies_of_two_sides(void **state) {
  for (int side = 0; side < 6; side++) {
    const int axis = side / 2, across = (axis + 1) % 3;
    vxm_soup *soup = new_soup(*state);
    add_cube(soup, 0);
    add_cube(soup, 0);
    for (size_t v = 8; v < 16; v++) {
      double *p = &soup->positions[3 * v];
      p[axis] = side % 2 == 0 ? -0.25 * p[axis] : 1 + 0.25 * p[axis];
      p[across] *= 0.5;
    }
    for (size_t c = 24; c < 48; c += 4) {
      const uint32_t *corner = &soup->indices[c];
      add_face(soup, (uint32_t[]){corner[3], corner[2], corner[1], corner[0]}, 4);
    }
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, NULL, &report);
    assert_int_equal(out->face_count, 12);
    assert_true(report.after->closed && report.after->volume > 1.124999 && report.after->volume < 1.125001);
    assert_repair_is_done(out, NULL);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** A strip of slivers, each of which can only go when the next one has gone. */
static void zero_area_chain(void **state) {
  enum { N = 60000 };
  for (int backward = 0; backward < 2; backward++) {
    vxm_soup *soup = new_soup(*state);
    add_cube(soup, 0);
    for (int v = 0; v < N + 2; v++)
      add_vertex(soup, (double)v / N, 0.5, 0.5);
    for (uint32_t i = 0; i < N; i++) {
      uint32_t f = 8 + (backward ? N - 1 - i : i);
      add_triangle(soup, f, f + 1, f + 2);
    }
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, NULL, &report);
    assert_int_equal(count_of(&report, "zero_area_faces"), N);
    assert_int_equal(out->face_count, 6);
    assert_int_equal(out->vertex_count, 8);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void duplicates(void **state) {
  vxm_soup *soup = new_pyramid(*state), *clean = new_pyramid(*state);
  add_triangle(soup, 4, 0, 1);
  add_triangle(soup, 0, 4, 1);
  add_triangle(soup, 1, 0, 4);
  uint32_t base[4] = {2, 3, 0, 1};
  add_face(soup, base, 4);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  /* 0 1 4 again; 0 4 1 twice, of which one repeats the other; the base turned over */
  assert_int_equal(count_of(&report, "duplicate_faces"), 2);
  assert_int_equal(count_of(&report, "opposite_duplicate_faces"), 2);
  assert_same_soup(out, clean);
  vxm_soup_destroy(out);
  vxm_repair_options keep = VXM_REPAIR_OPTIONS_INIT;
  keep.keep_duplicates = true;
  out = repaired(soup, &keep, &report);
  assert_int_equal(count_all(&report), 0);
  assert_same_soup(out, soup);
  vxm_soup_destroy(out);
  vxm_soup_destroy(clean);
  vxm_soup_destroy(soup);
}

static void unused(void **state) {
  vxm_soup *soup = new_soup(*state);
  for (int v = 0; v < 9; v++)
    add_vertex(soup, v, v * v, v % 2);
  add_triangle(soup, 7, 3, 4);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "unused_vertices"), 6);
  assert_int_equal(out->vertex_count, 3);
  assert_true(out->positions[0] == 3 && out->positions[3] == 4 && out->positions[6] == 7);
  assert_memory_equal(out->indices, ((uint32_t[]){2, 0, 1}), 3 * sizeof(uint32_t));
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void notes_format_and_nothing(void **state) {
  vxm_soup *soup = new_soup(*state);
  vxm_warn(&soup->warnings, "line 3: something was odd");
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(out->warnings.count, 1);
  assert_string_equal(out->warnings.text[0], "line 3: something was odd");
  assert_string_equal(out->format, soup->format);
  assert_int_equal(out->face_count, 0);
  assert_int_equal(count_all(&report), 0);
  assert_false(report.after->watertight);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void bad_options(void **state) {
  vxm_soup *soup = new_pyramid(*state);
  for (int bad = 0; bad < 5; bad++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.weld = VXM_WELD_TOLERANCE;
    if (bad == 0)
      options.size = 2;
    else if (bad == 1)
      options.weld = (vxm_weld)7;
    else
      options.weld_tolerance = bad == 2 ? -1 : bad == 3 ? NAN : INFINITY;
    vxm_soup *out = soup;
    vxm_repair_report report = {0}, none = {0};
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_repair_run(&out, &report, soup, &options, &error), VXM_ERROR_ARGUMENT);
    assert_null(out);
    assert_int_equal(error.code, VXM_ERROR_ARGUMENT);
    assert_memory_equal(&report, &none, sizeof none);
  }
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(clean_mesh_stays),
      cmocka_unit_test(nonfinite),
      cmocka_unit_test(exact_weld),
      cmocka_unit_test(repeated_corners),
      cmocka_unit_test(zero_area_faces_that_close),
      cmocka_unit_test(zero_area_chain),
      cmocka_unit_test(duplicates),
      cmocka_unit_test(fins),
      cmocka_unit_test(bodies_of_two_sides),
      cmocka_unit_test(unused),
      cmocka_unit_test(notes_format_and_nothing),
      cmocka_unit_test(bad_options),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
