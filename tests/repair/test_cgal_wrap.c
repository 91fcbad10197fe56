/* SPDX-License-Identifier: BSD-3-Clause */
/** Wrapping. */
/* clang-format off: in this order, no argument hides the context of solids.h */
#include "../mesh/shared.h"
#include "repair_test.h"
#include "solids.h"
/* clang-format on */

static vxm_soup *wrap(const vxm_soup *soup, double alpha, double offset) {
  vxm_soup *out;
  vxm_error error = VXM_ERROR_INIT;
  if (cgal->wrap(&out, NULL, soup, alpha, offset, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return out;
}

/** Solid angle of a triangle as seen from a point, over 4 pi (Van Oosterom and Strackee 1983). */
static double angle_of(const double *a, const double *b, const double *c, const double *from) {
  double v[3][3], length[3], dots[3];
  const double *corner[3] = {a, b, c};
  for (int k = 0; k < 3; k++) {
    length[k] = distance_between(corner[k], from);
    for (int i = 0; i < 3; i++)
      v[k][i] = corner[k][i] - from[i];
  }
  for (int k = 0; k < 3; k++)
    dots[k] = v[k][0] * v[(k + 1) % 3][0] + v[k][1] * v[(k + 1) % 3][1] + v[k][2] * v[(k + 1) % 3][2];
  double volume = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                  v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                  v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
  double under =
      length[0] * length[1] * length[2] + dots[0] * length[2] + dots[1] * length[0] + dots[2] * length[1];
  return atan2(volume, under) / (2 * M_PI);
}

static bool is_around(const vxm_soup *skin, const double *p) {
  double sum = 0;
  for (size_t f = 0; f < skin->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(skin, f, &n);
    sum += angle_of(vxm_position(skin, corner[0]), vxm_position(skin, corner[1]),
                    vxm_position(skin, corner[2]), p);
  }
  return sum > 0.5;
}

/** Some corners and middles of faces lie inside. */
static void assert_contains(const vxm_soup *skin, const vxm_soup *soup) {
  size_t step = soup->face_count / 200 + 1;
  for (size_t f = 0; f < soup->face_count; f += step) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    double middle[3] = {0, 0, 0};
    for (size_t c = 0; c < n; c++) {
      for (int i = 0; i < 3; i++)
        middle[i] += vxm_position(soup, corner[c])[i] / (double)n;
      assert_true(is_around(skin, vxm_position(soup, corner[c])));
    }
    if (n == 3)
      assert_true(is_around(skin, middle));
  }
}

static void a_torn_ball(void **state) {
  (void)state;
  vxm_rng rng = {2};
  vxm_soup *ball = new_soup(context), *soup = new_soup(context);
  add_ball(ball, (double[]){0, 0, 0}, 1, 12, &upright, false);
  /* every face on vertices of its own, some missing, some twice, some turned, and a sheet across */
  for (size_t f = 0; f < ball->face_count; f++) {
    uint32_t first = (uint32_t)soup->vertex_count;
    for (int c = 0; c < 3; c++) {
      const double *p = vxm_position(ball, ball->indices[3 * f + (size_t)c]);
      add_vertex(soup, p[0], p[1], p[2]);
    }
    uint64_t kind = vxm_rng_below(&rng, 10);
    if (kind > 0)
      add_triangle(soup, first, first + (kind == 1 ? 2 : 1), first + (kind == 1 ? 1 : 2));
    if (kind == 2)
      add_triangle(soup, first + 1, first + 2, first);
  }
  add_triangle(soup, 0, 100, 200);
  vxm_soup *out = wrap(soup, 0.4, 0.02);
  assert_solid(out);
  assert_contains(out, soup);
  assert_true(volume_of(out) > 4 && volume_of(out) < 5);
  vxm_soup *again = wrap(soup, 0.4, 0.02);
  assert_same_soup(out, again);
  vxm_soup_destroy(again);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(ball);
}

/** Each face of the skin is told the face of the soup that is nearest to its middle. */
static void what_lies_beneath(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context), *out;
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  add_cuboid(soup, 5, 0, 0, 6, 1, 1);
  uint64_t *nearest;
  assert_int_equal(cgal->wrap(&out, &nearest, soup, 0.3, 0.02, NULL), VXM_OK);
  assert_true(out->face_count > 100);
  bool seen[24] = {false};
  for (size_t f = 0; f < out->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(out, f, &n);
    double middle[3] = {0, 0, 0}, least = 100, of_nearest = 100;
    for (size_t c = 0; c < 3; c++)
      for (int i = 0; i < 3; i++)
        middle[i] += vxm_position(out, corner[c])[i] / 3;
    assert_true(nearest[f] < soup->face_count);
    /* the two triangles of a side lie in one plane: distances to the planes' rectangles */
    for (size_t g = 0; g < soup->face_count; g += 2) {
      double low[3], high[3], square = 0;
      for (int i = 0; i < 3; i++) {
        low[i] = 100;
        high[i] = -100;
        for (size_t c = 0; c < 6; c++) {
          double x = vxm_position(soup, soup->indices[3 * g + c])[i];
          low[i] = fmin(low[i], x);
          high[i] = fmax(high[i], x);
        }
        double off = fmax(0, fmax(low[i] - middle[i], middle[i] - high[i]));
        square += off * off;
      }
      least = fmin(least, square);
      if (nearest[f] / 2 == g / 2)
        of_nearest = square;
    }
    assert_true(of_nearest <= least + 1e-12);
    seen[nearest[f]] = true;
  }
  for (int g = 0; g < 24; g++)
    assert_true(seen[g]);
  vxm_free(context, nearest);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void far_apart(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  add_cuboid(soup, 3, 0, 0, 4, 1, 1);
  vxm_soup *out = wrap(soup, 0.5, 0.05);
  assert_solid(out);
  assert_contains(out, soup);
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&census, out, NULL), VXM_OK);
  assert_int_equal(census.components, 2);
  assert_true(volume_of(out) > 2 && volume_of(out) < 3);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void arguments(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context), *out;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(cgal->wrap(&out, NULL, soup, 1, 1, &error), VXM_ERROR_EMPTY);
  add_vertex(soup, 0, 0, 0);
  add_vertex(soup, 1, 0, 0);
  add_vertex(soup, 2, 0, 0);
  add_triangle(soup, 0, 1, 2);
  assert_int_equal(cgal->wrap(&out, NULL, soup, 1, 1, &error), VXM_ERROR_EMPTY);
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  const double bad[4] = {0, -1, NAN, INFINITY};
  for (int i = 0; i < 4; i++) {
    assert_int_equal(cgal->wrap(&out, NULL, soup, bad[i], 1, &error), VXM_ERROR_ARGUMENT);
    assert_int_equal(cgal->wrap(&out, NULL, soup, 1, bad[i], &error), VXM_ERROR_ARGUMENT);
  }
  vxm_soup_destroy(soup);
}

static void what_would_fit(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.memory_limit = 4 << 20;
  vxm_context *owner;
  assert_int_equal(vxm_context_create(&owner, &options, NULL), VXM_OK);
  vxm_soup *soup = new_soup(owner), *out;
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(cgal->wrap(&out, NULL, soup, 1e-4, 1e-5, &error), VXM_ERROR_MEMORY_LIMIT);
  const char *told = strstr(error.text, "an alpha ");
  assert_non_null(told);
  double fits = 1e-4 * strtod(told + strlen("an alpha "), NULL);
  assert_true(fits > 1e-3 && fits < 0.5);
  if (cgal->wrap(&out, NULL, soup, fits, fits / 20, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_solid(out);
  assert_true(vxm_context_peak_bytes(owner) <= options.memory_limit);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  vxm_context_destroy(owner);
}

static int stop_soon(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  return ++*(int *)payload > 5;
}

static void cancelled(void **state) {
  (void)state;
  int calls = 0;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = stop_soon;
  options.payload = &calls;
  vxm_context *owner;
  assert_int_equal(vxm_context_create(&owner, &options, NULL), VXM_OK);
  vxm_soup *soup = new_soup(owner), *out;
  add_ball(soup, (double[]){0, 0, 0}, 1, 12, &upright, false);
  assert_int_equal(cgal->wrap(&out, NULL, soup, 0.01, 0.001, NULL), VXM_ERROR_CANCELLED);
  assert_null(out);
  assert_int_equal(calls, 6);
  vxm_soup_destroy(soup);
  vxm_context_destroy(owner);
}

static void shared_meshes(void **state) {
  (void)state;
  static const char *const names[] = {"modelnet/gomesh-chair_0001.off", "modelnet/panoview-stool_0002.off",
                                      "messy/trimesh-soup.stl", "messy/openscad-bad-stl-wing.stl"};
  const char *source = getenv("SRCDIR");
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    char path[1024];
    snprintf(path, sizeof path, "%s/../shared/meshes/%s", source ? source : ".", names[i]);
    FILE *file = fopen(path, "rb");
    if (!file)
      continue;
    fclose(file);
    vxm_soup *soup = read_soup(context, path);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
    double alpha = distance_between(census.bounds, census.bounds + 3) / 15;
    vxm_soup *out = wrap(soup, alpha, alpha / 20);
    assert_solid(out);
    assert_contains(out, soup);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** A power of two changes no digit, however large or small the model is by it. */
static void any_size(void **state) {
  (void)state;
  static const int powers[] = {500, -500, 1000, -900};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  options.wrap_alpha = 0.1;
  vxm_soup *ball = new_soup(context);
  add_ball(ball, (double[]){3, 0, 0}, 1, 8, &upright, false);
  vxm_soup *usual = repaired(ball, &options, &report);
  assert_true(usual->face_count > 100);
  for (size_t p = 0; p < sizeof powers / sizeof *powers; p++) {
    vxm_soup *sized;
    assert_int_equal(vxm_soup_copy(&sized, ball, NULL), VXM_OK);
    for (size_t i = 0; i < 3 * sized->vertex_count; i++)
      sized->positions[i] = ldexp(sized->positions[i], powers[p]);
    vxm_soup *wrapped = repaired(sized, &options, &report);
    for (size_t i = 0; i < 3 * wrapped->vertex_count; i++)
      wrapped->positions[i] = ldexp(wrapped->positions[i], -powers[p]);
    assert_same_soup(usual, wrapped);
    vxm_soup_destroy(wrapped);
    vxm_soup_destroy(sized);
  }
  vxm_soup_destroy(usual);
  vxm_soup_destroy(ball);
}

int main(void) {
  if (!open_cgal())
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_torn_ball),   cmocka_unit_test(what_lies_beneath), cmocka_unit_test(far_apart),
      cmocka_unit_test(arguments),     cmocka_unit_test(what_would_fit),    cmocka_unit_test(cancelled),
      cmocka_unit_test(shared_meshes), cmocka_unit_test(any_size),
  };
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
