/* SPDX-License-Identifier: BSD-3-Clause */
/** Plates of open sheets: their volumes to the last digits, and random complexes against winding numbers. */
#include "repair_test.h"
#include "solids.h"

#include "mesh/geometry.h"
#include "repair/sheets/thicken.h"

/** The plates of all faces. */
static vxm_soup *plates_of(const vxm_soup *sheets, double thickness) {
  vxm_soup *out = new_soup(context);
  uint64_t *origin = NULL;
  uint8_t *all = malloc(sheets->face_count);
  vxm_error error = VXM_ERROR_INIT;
  assert_non_null(all);
  memset(all, 1, sheets->face_count);
  if (vxm_thicken(out, &origin, sheets, all, thickness, &error) != VXM_OK)
    fail_msg("%s", error.text);
  for (size_t f = 0; f < out->face_count; f++)
    assert_true(origin[f] < sheets->face_count);
  vxm_free(context, origin);
  free(all);
  return out;
}

static void check_volume(const vxm_soup *sheets, double thickness, double volume) {
  vxm_soup *plates = plates_of(sheets, thickness);
  assert_closed_manifold(plates);
  assert_true(fabs(volume_of(plates) - volume) < 1e-12);
  vxm_soup_destroy(plates);
}

/** A rectangle of n x n squares between two corners, spanned by two vectors. */
static void add_wall(vxm_soup *soup, const double p[3], const double u[3], const double v[3], uint32_t n) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t j = 0; j <= n; j++)
    for (uint32_t i = 0; i <= n; i++)
      add_vertex(soup, p[0] + (u[0] * i + v[0] * j) / n, p[1] + (u[1] * i + v[1] * j) / n,
                 p[2] + (u[2] * i + v[2] * j) / n);
  for (uint32_t j = 0; j < n; j++)
    for (uint32_t i = 0; i < n; i++) {
      uint32_t a = first + j * (n + 1) + i, up = a + n + 1;
      uint32_t square[4] = {a, a + 1, up + 1, up};
      add_face(soup, square, 4);
    }
}

/* ---- Plates that are known ---- */

static void test_square(void **state) {
  (void)state;
  for (uint32_t n = 1; n < 5; n++) {
    vxm_soup *soup = new_soup(context);
    add_wall(soup, (double[]){0, 0, 0}, (double[]){1, 0, 0}, (double[]){0, 1, 0}, n);
    check_volume(soup, 0.25, 0.25);
    vxm_soup *plates = plates_of(soup, 0.25);
    for (size_t i = 0; i < plates->vertex_count; i++)
      assert_true(fabs(vxm_position(plates, i)[2]) == 0.125);
    vxm_soup_destroy(plates);
    vxm_soup_destroy(soup);
  }
}

/** Plates are as thick as they are to be, whatever that is, wherever they lie, and turned. */
static void test_thickness(void **state) {
  (void)state;
  vxm_rng rng = {7};
  static const double far_off[] = {0, 1, 10, 1000, 1e5};
  for (int turned = 0; turned < 3; turned++)
    for (int f = 0; f < 5; f++) {
      frame3 frame = turned ? random_frame(&rng) : upright;
      vxm_soup *soup = new_soup(context);
      add_wall(soup, (double[]){0, 0, 0}, (double[]){1, 0, 0}, (double[]){0, 1, 0}, 2);
      add_wall(soup, (double[]){3, 0, 0}, (double[]){1, 0, 0}, (double[]){0, 0.7, 0}, 1);
      double *p = soup->positions;
      for (size_t v = 0; v < soup->vertex_count; v++, p += 3) {
        const double q[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; i++)
          p[i] =
              frame.m[i][0] * q[0] + frame.m[i][1] * q[1] + frame.m[i][2] * q[2] + (1 - 0.3 * i) * far_off[f];
      }
      vxm_soup *plates = plates_of(soup, 0.1);
      assert_closed_manifold(plates);
      for (size_t v = plates->vertex_count; v-- > 0;) /* for the sum's sake */
        for (size_t i = 0; i < 3; i++)
          plates->positions[3 * v + i] -= plates->positions[i];
      if (fabs(volume_of(plates) - 0.17) > 1e-9 + 1e-15 * far_off[f])
        fail_msg("turned %d, %g off: %.12g", turned, far_off[f], volume_of(plates));
      vxm_soup_destroy(plates);
      vxm_soup_destroy(soup);
    }
}

/** Walls that meet at an edge, from all four sides or fewer: corners are mitred, and nothing is there twice.
 */
static void test_junctions(void **state) {
  (void)state;
  static const double out[4][3] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const double t = 0.125;
  for (unsigned walls = 1; walls < 16; walls++)
    for (uint32_t n = 1; n < 4; n++) {
      vxm_soup *soup = new_soup(context);
      unsigned count = 0;
      for (int w = 0; w < 4; w++)
        if (walls >> w & 1) {
          add_wall(soup, (double[]){0, 0, 0}, out[w], (double[]){0, 0, 1}, n);
          count++;
        }
      /* n walls at right angles: what they cover together of the square of t x t where they meet */
      double middle = count == 3 ? -t * t / 2 : count == 4 ? -t * t : 0;
      check_volume(soup, t, count * t + middle);
      vxm_soup_destroy(soup);
    }
}

/** A flap whose foot ends within a wall, and one on its rim. */
static void test_flaps(void **state) {
  (void)state;
  const double t = 0.125;
  for (int from = 0; from < 3; from++)
    for (int to = from + 1; to <= 3; to++) {
      vxm_soup *soup = new_soup(context);
      add_wall(soup, (double[]){0, 0, 0}, (double[]){3, 0, 0}, (double[]){0, 3, 0}, 3);
      for (int i = from; i < to; i++)
        add_wall(soup, (double[]){i, 1, 0}, (double[]){1, 0, 0}, (double[]){0, 0, 1}, 1);
      check_volume(soup, t, 9 * t + (to - from) * t * (1 - t / 2));
      vxm_soup_destroy(soup);
    }
}

/** A strip that turns by a number of half turns: of an odd number it has one side. */
static void test_twisted(void **state) {
  (void)state;
  enum { STEPS = 60 };
  for (int turns = 0; turns < 4; turns++) {
    vxm_soup *soup = new_soup(context);
    for (int i = 0; i < STEPS; i++) {
      double along = 2 * M_PI * i / STEPS, tilt = along * turns / 2;
      for (int side = -1; side < 2; side += 2) {
        double r = 2 + 0.3 * side * cos(tilt);
        add_vertex(soup, r * cos(along), r * sin(along), 0.3 * side * sin(tilt));
      }
    }
    for (uint32_t i = 0; i < STEPS; i++) {
      uint32_t a = 2 * i, b = a + 1, k = (i + 1) % STEPS, c = 2 * k, d = c + 1;
      if (k == 0 && turns % 2) {
        c = 1;
        d = 0;
      }
      add_triangle(soup, a, b, d);
      add_triangle(soup, a, d, c);
    }
    vxm_soup *plates = plates_of(soup, 0.01);
    assert_closed_manifold(plates);
    double area = 0.6 * 2 * M_PI * 2;
    assert_true(fabs(volume_of(plates) / (0.01 * area) - 1) < 0.1);
    vxm_soup_destroy(plates);
    vxm_soup_destroy(soup);
  }
}

/* ---- Whatever it is ---- */

static bool is_balanced(const vxm_soup *soup) {
  brute_report report = look_brute(soup);
  return report.boundary_edges == 0 && report.unpaired == 0;
}

/** Distance to the nearest corner, or to the plane of the nearest face if the point is beside none. */
static void random_point(double p[3], const vxm_soup *soup, size_t face, vxm_rng *rng) {
  double w[3], sum = 0;
  for (int i = 0; i < 3; i++)
    sum += w[i] = 0.2 + vxm_rng_unit(rng);
  memset(p, 0, 3 * sizeof *p);
  for (int i = 0; i < 3; i++)
    for (int a = 0; a < 3; a++)
      p[a] += w[i] / sum * vxm_position(soup, soup->indices[3 * face + (size_t)i])[a];
}

/**
 * Random triangles between few points, so that many meet at each edge: the surface is balanced along each
 * edge (where faces of a sheet are joined at a vertex by a bridge, two of its sheets may share an edge), and
 * winds at least once around points of the faces, and as often as it should, which is not at all, around
 * others.
 */
static void test_random(void **state) {
  (void)state;
  vxm_rng rng = {20};
  int manifold = 0, missed = 0;
  enum { TRIALS = 400 };
  for (int trial = 0; trial < TRIALS; trial++) {
    vxm_soup *soup = new_soup(context);
    uint32_t points = 4 + (uint32_t)vxm_rng_below(&rng, 6), faces = 1 + (uint32_t)vxm_rng_below(&rng, 14);
    for (uint32_t v = 0; v < points; v++)
      add_vertex(soup, vxm_rng_unit(&rng), vxm_rng_unit(&rng), vxm_rng_unit(&rng));
    for (uint32_t f = 0; f < faces; f++) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, points), b = (uint32_t)vxm_rng_below(&rng, points - 1),
               c = (uint32_t)vxm_rng_below(&rng, points - 2);
      b += b >= a;
      c += c >= (a < b ? a : b);
      c += c >= (a < b ? b : a);
      add_triangle(soup, a, b, c);
    }
    const double t = 1e-5;
    vxm_soup *plates = plates_of(soup, t);
    assert_true(is_balanced(plates));
    manifold += look_brute(plates).manifold;
    for (int i = 0; i < 20; i++) {
      double p[3];
      random_point(p, soup, (size_t)vxm_rng_below(&rng, faces), &rng);
      missed += winding_at(plates, p) < 0.99;
      for (int a = 0; a < 3; a++)
        p[a] = 1.4 * vxm_rng_unit(&rng) - 0.2;
      bool near = false;
      for (size_t f = 0; f < soup->face_count; f++) {
        vxm_vec3 n = vxm_polygon_area(soup->positions, soup->indices + 3 * f, 3, 1);
        vxm_vec3 d = vxm_vec3_between(p, vxm_position(soup, soup->indices[3 * f]), 1);
        near = near || fabs(vxm_vec3_dot(n, d)) < 4 * t * vxm_vec3_length(n);
      }
      assert_true(near || fabs(winding_at(plates, p)) < 0.01);
    }
    vxm_soup_destroy(plates);
    vxm_soup_destroy(soup);
  }
  assert_true(manifold > TRIALS * 9 / 10);
  assert_true(missed <= 20 * TRIALS / 1000); /* where no vertex can move beyond all faces about it */
}

/* ---- As a repair ---- */

static vxm_soup *closed_of(const vxm_soup *soup, vxm_sheets sheets, vxm_repair_report *report) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  options.sheets = sheets;
  options.thickness = 1.0 / 64; /* on the lattice that vertices are put on */
  return repaired(soup, &options, report);
}

/** A box, a wall through it and one beside it, each with a tag. */
static vxm_soup *box_and_walls(void) {
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  add_wall(soup, (double[]){-1, 0.25, 0.25}, (double[]){3, 0, 0}, (double[]){0, 0, 0.5}, 2);
  add_wall(soup, (double[]){4, 0, 0}, (double[]){1, 0, 0}, (double[]){0, 1, 0}, 1);
  static const char *const names[] = {"box", "through", "beside"};
  uint32_t tag;
  for (int i = 0; i < 3; i++)
    assert_int_equal(vxm_soup_add_tag(soup, names[i], strlen(names[i]), &tag, NULL), VXM_OK);
  soup->face_tags = vxm_calloc(context, soup->face_count, sizeof *soup->face_tags, NULL);
  for (size_t f = 12; f < soup->face_count; f++)
    soup->face_tags[f] = f < 16 ? 1 : 2;
  return soup;
}

static void test_repair(void **state) {
  (void)state;
  vxm_soup *soup = box_and_walls();
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_soup *out = closed_of(soup, VXM_SHEETS_THICKEN, &report);
  assert_closed_manifold(out);
  const double t = 1.0 / 64;
  assert_true(fabs(volume_of(out) - (1 + 2.5 * t)) < 1e-12);
  assert_int_equal(report.sheets, 2);
  assert_int_equal(report.open_parts, 0);
  int64_t tags[3] = {0};
  for (size_t f = 0; f < out->face_count; f++)
    tags[out->face_tags[f]]++;
  assert_int_equal(tags[0], 12);
  assert_int_equal(tags[1], 2 * 8 + 2 * 8);
  assert_int_equal(tags[2], 12);
  vxm_soup *again = closed_of(out, VXM_SHEETS_THICKEN, &report);
  assert_same_soup(again, out);
  assert_int_equal(count_all(&report), 0);
  vxm_soup_destroy(again);
  vxm_soup_destroy(out);
  out = closed_of(soup, VXM_SHEETS_DROP, &report);
  assert_true(volume_of(out) == 1 && out->face_count == 12);
  assert_int_equal(report.sheets, 2);
  vxm_soup_destroy(out);
  out = closed_of(soup, VXM_SHEETS_KEEP, &report);
  assert_int_equal(report.sheets, 0);
  assert_int_equal(report.open_parts, 2);
  assert_int_equal(out->face_count, soup->face_count);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** Far from the origin, and in 32-bit floats, plates are as thick as numbers can tell. */
static void test_coarse(void **state) {
  (void)state;
  for (int single = 0; single < 2; single++) {
    vxm_soup *soup = new_soup(context);
    add_wall(soup, (double[]){1e6, 1e6, 1e6}, (double[]){8, 0, 0}, (double[]){0, 8, 0}, 2);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = VXM_LEVEL_CLOSED;
    options.single_precision = single;
    vxm_soup *out = repaired(soup, &options, NULL);
    assert_closed_manifold(out);
    for (size_t i = 0; i < 3 * out->vertex_count; i++)
      out->positions[i] -= 1e6; /* where volumes can be told */
    assert_true(volume_of(out) > (single ? 64 : 1));
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** More than the model is wide is a mistake of units: what came of it had no volume. */
static void test_too_thick(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context), *out = NULL;
  add_wall(soup, (double[]){5, 5, 5}, (double[]){3, 0, 0}, (double[]){0, 4, 0}, 1);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  static const double thicknesses[] = {1e-3, 5, 5.001, 1e4, 1e30};
  for (int i = 0; i < 5; i++) {
    vxm_error error = VXM_ERROR_INIT;
    options.thickness = thicknesses[i];
    options.sheets = VXM_SHEETS_THICKEN;
    vxm_status status = vxm_repair_run(&out, NULL, soup, &options, &error);
    assert_int_equal(status, i < 2 ? VXM_OK : VXM_ERROR_ARGUMENT);
    assert_true(i < 2 || strstr(error.text, "the diagonal of the whole model, 5"));
    vxm_soup_destroy(i < 2 ? out : NULL);
    options.sheets = VXM_SHEETS_DROP; /* nothing becomes that thick */
    assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_OK);
    vxm_soup_destroy(out);
  }
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_square), cmocka_unit_test(test_thickness), cmocka_unit_test(test_junctions),
      cmocka_unit_test(test_flaps),  cmocka_unit_test(test_twisted),   cmocka_unit_test(test_random),
      cmocka_unit_test(test_repair), cmocka_unit_test(test_coarse),    cmocka_unit_test(test_too_thick)};
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
