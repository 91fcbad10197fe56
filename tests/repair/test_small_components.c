/* SPDX-License-Identifier: BSD-3-Clause */
/** Dropping of small components. */
#include "repair_test.h"

#include <math.h>

/** A box, its sides cut into n x n squares; without its top if it is open. */
static void add_box(vxm_soup *soup, double x, double size, uint32_t n, bool open) {
  uint32_t first = (uint32_t)soup->vertex_count, row = n + 1, plane = row * row;
  for (uint32_t v = 0; v < plane * row; v++)
    add_vertex(soup, x + size * (v % row) / n, size * (v / row % row) / n, size * (v / plane) / n);
  const uint32_t step[3] = {1, row, plane};
  for (unsigned side = 0; side < 6; side++)
    for (uint32_t i = 0; i < n * n && !(open && side == 5); i++) {
      unsigned axis = side >> 1;
      uint32_t u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];
      uint32_t base = first + (side & 1 ? n * step[axis] : 0) + i % n * u + i / n * v;
      uint32_t corners[4] = {base, base + (side & 1 ? u : v), base + u + v, base + (side & 1 ? v : u)};
      add_face(soup, corners, 4);
    }
}

typedef struct body {
  double x, size;
  uint32_t n;
  bool open;
} body;

static int64_t faces_of(const body *b) {
  return (b->open ? 5 : 6) * (int64_t)b->n * b->n;
}

static double area_of(const body *b, bool closed) {
  return (b->open && !closed ? 5 : 6) * b->size * b->size;
}

static vxm_soup *scene(vxm_context *context, const body *bodies, size_t count, const bool *with) {
  vxm_soup *soup = new_soup(context);
  for (size_t i = 0; i < count; i++)
    if (!with || with[i])
      add_box(soup, bodies[i].x, bodies[i].size, bodies[i].n, bodies[i].open);
  return soup;
}

static void check_scene(vxm_context *context, const body *bodies, size_t count, vxm_repair_options options) {
  bool stays[16];
  size_t largest = 0;
  int64_t dropped = 0;
  for (size_t i = 1; i < count; i++)
    if (area_of(&bodies[i], options.fill_holes != 0) > area_of(&bodies[largest], options.fill_holes != 0))
      largest = i;
  for (size_t i = 0; i < count; i++) {
    const body *b = &bodies[i];
    bool closed = !b->open || options.fill_holes != 0;
    int64_t cap = b->n == 1 ? 2 : 4 * (int64_t)b->n, faces = faces_of(b) + (b->open && closed ? cap : 0);
    stays[i] = i == largest ||
               !(faces < options.drop_faces || (closed && b->size * b->size * b->size < options.drop_volume));
    dropped += stays[i] ? 0 : faces;
  }
  REPAIR_REPORT(report);
  vxm_repair_options keep = options;
  keep.drop_faces = 0;
  keep.drop_volume = 0;
  vxm_soup *all = scene(context, bodies, count, NULL), *some = scene(context, bodies, count, stays);
  vxm_soup *out = repaired(all, &options, &report), *expected = repaired(some, &keep, NULL);
  assert_int_equal(count_of(&report, "small_parts"), dropped);
  assert_int_equal(out->face_count, expected->face_count);
  assert_int_equal(out->vertex_count, expected->vertex_count);
  if (options.fill_holes == 0)
    assert_same_soup(out, expected);
  assert_repair_is_done(out, &options);
  vxm_soup_destroy(expected);
  vxm_soup_destroy(out);
  vxm_soup_destroy(some);
  vxm_soup_destroy(all);
}

/** Any bodies and any thresholds: those stay that should. */
static void scenes(void **state) {
  vxm_rng rng = {1};
  for (int round = 0; round < 400; round++) {
    body bodies[16];
    size_t count = 1 + (size_t)vxm_rng_below(&rng, 8);
    double x = round % 3 ? 0 : 1e5, unit = round % 2 ? 1 : 1e-3;
    for (size_t i = 0; i < count; i++) {
      double size = unit * (0.5 + (double)vxm_rng_below(&rng, 8) + 0.01 * (double)i); /* no two alike */
      bodies[i] = (body){x, size, 1 + (uint32_t)vxm_rng_below(&rng, 5), vxm_rng_below(&rng, 3) == 0};
      x += 3 * size;
    }
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    if (vxm_rng_below(&rng, 2))
      options.drop_faces = 1 + (int64_t)vxm_rng_below(&rng, 160);
    if (vxm_rng_below(&rng, 2))
      options.drop_volume = unit * unit * unit * 343 * vxm_rng_unit(&rng);
    options.fill_holes = vxm_rng_below(&rng, 3) == 0 ? -1 : 0;
    check_scene(*state, bodies, count, options);
  }
}

/** The one with the largest area stays, even if it has the fewest faces, and even if it has no volume. */
static void largest_stays(void **state) {
  const body bodies[3] = {{0, 1, 6, false}, {10, 20, 1, true}, {50, 2, 8, false}};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.drop_faces = INT64_MAX;
  options.drop_volume = 1e9;
  vxm_soup *soup = scene(*state, bodies, 3, NULL), *out = repaired(soup, &options, NULL);
  assert_int_equal(out->face_count, 5);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  soup = new_soup(*state);
  out = repaired(soup, &options, NULL);
  assert_int_equal(out->face_count, 0);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** Components are those after welding: a body of loose faces is one, not many. */
static void parts_are_welded_first(void **state) {
  vxm_soup *box = new_soup(*state), *soup = new_soup(*state);
  add_box(box, 0, 1, 3, false);
  add_box(box, 5, 0.5, 3, false);
  for (size_t f = 0; f < box->face_count; f++) {
    size_t n;
    const uint32_t *face = vxm_face(box, f, &n);
    uint32_t corners[4];
    for (size_t i = 0; i < n; i++) {
      const double *p = vxm_position(box, face[i]);
      corners[i] = (uint32_t)soup->vertex_count;
      add_vertex(soup, p[0], p[1], p[2]);
    }
    add_face(soup, corners, n);
  }
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.drop_faces = 54;
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, &options, &report);
  assert_int_equal(out->face_count, 108);
  vxm_soup_destroy(out);
  options.drop_faces = 55;
  out = repaired(soup, &options, &report);
  assert_int_equal(out->face_count, 54);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(box);
}

static void turn_faces(vxm_soup *soup, size_t first) {
  for (size_t c = first; c < soup->corner_count; c += 4) {
    uint32_t kept = soup->indices[c + 1];
    soup->indices[c + 1] = soup->indices[c + 3];
    soup->indices[c + 3] = kept;
  }
}

/** What was a cavity is a body once the shell around it is gone, and is turned for it. */
static void cavity_without_its_shell(void **state) {
  vxm_soup *soup = new_soup(*state);
  add_box(soup, 0, 3, 1, false);
  size_t first = soup->corner_count;
  add_box(soup, 1, 1, 4, false);
  for (size_t v = 8; v < soup->vertex_count; v++)
    for (int a = 1; a < 3; a++)
      soup->positions[3 * v + (size_t)a] += 1;
  turn_faces(soup, first);
  add_box(soup, 10, 5, 4, false);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, &options, &report);
  assert_true(fabs(report.after->volume - (27 - 1 + 125)) < 1e-9);
  vxm_soup_destroy(out);
  options.drop_faces = 50;
  out = repaired(soup, &options, &report);
  assert_true(fabs(report.after->volume - (1 + 125)) < 1e-9);
  assert_repair_is_done(out, &options);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** A cube with its corners on the diagonal, in or out. */
static void add_shell(vxm_soup *soup, double at, double size, bool inward) {
  size_t first = soup->corner_count, vertex = soup->vertex_count;
  add_box(soup, at, size, 1, false);
  for (size_t v = vertex; v < soup->vertex_count; v++)
    for (int a = 1; a < 3; a++)
      soup->positions[3 * v + (size_t)a] += at;
  if (inward)
    turn_faces(soup, first);
}

/** Cavities are no crumbs: they stay with what they are in, and go with it; what is in them is a part of its
 * own. */
static void cavities_stay(void **state) {
  static const struct {
    double drop, volume;
    int64_t faces;
  } cases[] = {
      {0.001, 1000 - 27 - 1 + 0.125 + 8 - 1, 36},
      {0.2, 1000 - 27 - 1 + 8 - 1, 30},
      {1.5, 1000 - 27 - 1 + 8 - 1, 30},
      {9, 1000 - 27 - 1, 18},
      {500, 1000 - 27 - 1, 18},
  };
  vxm_soup *soup = new_soup(*state);
  add_shell(soup, 0, 10, false);
  add_shell(soup, 2, 3, true);
  add_shell(soup, 3, 0.5, false); /* in the first cavity */
  add_shell(soup, 7, 1, true);
  add_shell(soup, 20, 2, false);
  add_shell(soup, 20.5, 1, true); /* goes with its shell */
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    for (int by_faces = 0; by_faces < 2; by_faces++) {
      vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
      options.drop_volume = cases[i].drop;
      options.drop_faces = by_faces ? 7 : 0;
      REPAIR_REPORT(report);
      vxm_soup *out = repaired(soup, &options, &report);
      assert_int_equal(out->face_count, by_faces ? 18 : cases[i].faces);
      assert_true(fabs(report.after->volume - (by_faces ? 1000 - 27 - 1 : cases[i].volume)) < 1e-9);
      assert_repair_is_done(out, &options);
      vxm_soup_destroy(out);
    }
  vxm_soup_destroy(soup);
}

static void options_refused(void **state) {
  vxm_soup *soup = new_soup(*state), *out;
  const int64_t faces[] = {-1, 0, 0};
  const double volumes[] = {0, -1, NAN};
  for (int i = 0; i < 3; i++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_error error = VXM_ERROR_INIT;
    options.drop_faces = faces[i];
    options.drop_volume = volumes[i];
    assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, &error), VXM_ERROR_ARGUMENT);
  }
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scenes),
      cmocka_unit_test(largest_stays),
      cmocka_unit_test(parts_are_welded_first),
      cmocka_unit_test(cavity_without_its_shell),
      cmocka_unit_test(cavities_stay),
      cmocka_unit_test(options_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
