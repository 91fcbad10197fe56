/* SPDX-License-Identifier: BSD-3-Clause */
/** Self-intersections against whole numbers. */
#include "solids.h"

/* ---- An oracle in whole numbers ---- */

typedef int64_t whole[3];

/** A point x/w, y/w, z/w; w > 0. */
typedef struct fraction_point {
  int64_t x[3], w;
} fraction_point;

static void cross(const whole a, const whole b, whole out) {
  for (int i = 0; i < 3; i++)
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static int64_t dot(const whole a, const whole b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void minus(const whole a, const whole b, whole out) {
  for (int i = 0; i < 3; i++)
    out[i] = a[i] - b[i];
}

static void normal(whole t[3], whole out) {
  whole p, q;
  minus(t[1], t[0], p);
  minus(t[2], t[0], q);
  cross(p, q, out);
}

static bool is_flat(whole t[3]) {
  whole n;
  normal(t, n);
  return n[0] == 0 && n[1] == 0 && n[2] == 0;
}

/** Whether a point lies in a triangle, border included. */
static bool in_triangle(whole t[3], const fraction_point *p) {
  whole n;
  normal(t, n);
  if (dot(n, p->x) != dot(n, t[0]) * p->w)
    return false;
  for (int k = 0; k < 3; k++) {
    whole along, to, turned;
    minus(t[(k + 1) % 3], t[k], along);
    for (int i = 0; i < 3; i++)
      to[i] = p->x[i] - t[k][i] * p->w;
    cross(along, to, turned);
    if (dot(n, turned) < 0)
      return false;
  }
  return true;
}

static bool same_place(const whole a, const whole b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/** Whether a point, which lies in both triangles, is neither a corner nor on an edge that they share. */
static bool is_elsewhere(const fraction_point *p, whole shared[3], int count) {
  if (count == 0 || count == 3)
    return true;
  whole to, along, turned;
  for (int i = 0; i < 3; i++)
    to[i] = p->x[i] - shared[0][i] * p->w;
  if (count == 1)
    return to[0] != 0 || to[1] != 0 || to[2] != 0;
  minus(shared[1], shared[0], along);
  cross(along, to, turned);
  return turned[0] != 0 || turned[1] != 0 || turned[2] != 0;
}

/**
 * What two triangles share is convex, so it is elsewhere if one of its extreme points is: a corner of one in
 * the other, a side through the plane of the other, or two sides that cross in one plane.
 */
static bool meet(whole t[3], whole u[3]) {
  whole shared[3];
  int count = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (same_place(t[i], u[j]))
        memcpy(shared[count++], t[i], sizeof shared[0]);
  if (count == 3)
    return true;
  for (int turn = 0; turn < 2; turn++) {
    whole *a = turn ? u : t, *b = turn ? t : u, n;
    normal(b, n);
    for (int k = 0; k < 3; k++) {
      fraction_point p = {{a[k][0], a[k][1], a[k][2]}, 1};
      if (in_triangle(a, &p) && in_triangle(b, &p) && is_elsewhere(&p, shared, count))
        return true;
      const int64_t *from = a[k], *to = a[(k + 1) % 3];
      int64_t above = dot(n, from) - dot(n, b[0]), below = dot(n, to) - dot(n, b[0]);
      if ((above > 0 && below < 0) || (above < 0 && below > 0)) {
        int64_t up = above < 0 ? -above : above, down = below < 0 ? -below : below;
        p.w = up + down;
        for (int i = 0; i < 3; i++)
          p.x[i] = from[i] * down + to[i] * up;
        if (in_triangle(b, &p) && is_elsewhere(&p, shared, count))
          return true;
      }
      for (int l = 0; l < 3 && above == 0 && below == 0; l++) {
        /* from + s * along meets b[l] + r * other: s = ((b[l] - from) x other) . n / (along x other) . n */
        whole along, other, between, turned;
        minus(to, from, along);
        minus(b[(l + 1) % 3], b[l], other);
        minus(b[l], from, between);
        cross(along, other, turned);
        int64_t under = dot(turned, n);
        cross(between, other, turned);
        int64_t over = dot(turned, n);
        if (under < 0) {
          under = -under;
          over = -over;
        }
        if (under == 0 || over < 0 || over > under)
          continue;
        p.w = under;
        for (int i = 0; i < 3; i++)
          p.x[i] = from[i] * under + along[i] * over;
        if (in_triangle(b, &p) && is_elsewhere(&p, shared, count))
          return true;
      }
    }
  }
  return false;
}

static void corners_of(const vxm_soup *soup, size_t face, whole out[3]) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  assert_int_equal(count, 3);
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 3; i++)
      out[k][i] = (int64_t)vxm_position(soup, corner[k])[i];
}

/* ---- Tests ---- */

static vxm_face_pairs find(const vxm_soup *soup, size_t most) {
  vxm_face_pairs pairs;
  vxm_error error = VXM_ERROR_INIT;
  if (cgal->self_intersections(&pairs, soup, most, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return pairs;
}

static void check_against_oracle(const vxm_soup *soup) {
  vxm_face_pairs pairs = find(soup, SIZE_MAX);
  assert_true(pairs.complete);
  size_t at = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    for (size_t g = f + 1; g < soup->face_count; g++) {
      whole t[3], u[3];
      corners_of(soup, f, t);
      corners_of(soup, g, u);
      bool listed = at < pairs.count && pairs.pairs[at].first == f && pairs.pairs[at].second == g;
      at += listed;
      if (listed != (!is_flat(t) && !is_flat(u) && meet(t, u)))
        fail_msg("faces %zu and %zu are %s", f, g, listed ? "listed" : "not listed");
    }
  assert_int_equal(at, pairs.count);
  vxm_free(soup->context, pairs.pairs);
}

static void soups_agree_with_the_oracle(void **state) {
  (void)state;
  vxm_rng rng = {1};
  for (int round = 0; round < 4000; round++) {
    vxm_soup *soup = new_soup(context);
    uint64_t lattice = 2 + vxm_rng_below(&rng, 6), vertices = 4 + vxm_rng_below(&rng, 9);
    for (uint64_t v = 0; v < vertices; v++)
      add_vertex(soup, (double)vxm_rng_below(&rng, lattice), (double)vxm_rng_below(&rng, lattice),
                 round % 5 == 0 ? 1 : (double)vxm_rng_below(&rng, lattice));
    for (int f = 0; f < 10; f++) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, vertices), b = (uint32_t)vxm_rng_below(&rng, vertices),
               c = (uint32_t)vxm_rng_below(&rng, vertices);
      add_triangle(soup, a, b, c);
    }
    check_against_oracle(soup);
    vxm_soup_destroy(soup);
  }
}

static void far_from_the_origin(void **state) {
  (void)state;
  /* The corner of the second lies 1/2 above or below the plane of the first: nothing is lost to rounding. */
  for (int k = -1; k <= 1; k++) {
    double o = 0x1p51;
    vxm_soup *soup = new_soup(context);
    const double p[6][3] = {{o, o, o},
                            {o + 100, o, o},
                            {o, o + 100, o},
                            {o + 9, o + 9, o + k * 0.5},
                            {o + 8, o + 9, o + 50},
                            {o + 9, o + 8, o + 50}};
    for (int v = 0; v < 6; v++)
      add_vertex(soup, p[v][0], p[v][1], p[v][2]);
    add_triangle(soup, 0, 1, 2);
    add_triangle(soup, 3, 4, 5);
    vxm_face_pairs pairs = find(soup, 10);
    assert_int_equal(pairs.count, k <= 0);
    vxm_free(context, pairs.pairs);
    vxm_soup_destroy(soup);
  }
}

static void polygons(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  /* An L of six corners, which its fan from the first corner would leave, and a needle through its notch. */
  const double l[6][2] = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
  for (int v = 0; v < 6; v++)
    add_vertex(soup, l[v][0], l[v][1], 0);
  add_face(soup, (const uint32_t[]){2, 3, 4, 5, 0, 1}, 6);
  add_vertex(soup, 2, 2, -1);
  add_vertex(soup, 2.1, 2, 1);
  add_vertex(soup, 2, 2.1, 1);
  add_triangle(soup, 6, 7, 8);
  vxm_face_pairs pairs = find(soup, 10);
  assert_int_equal(pairs.count, 0);
  vxm_free(context, pairs.pairs);
  /* another one through the L; both of its triangles may be hit, but the pair is there once */
  add_vertex(soup, 0.5, 0.5, -1);
  add_vertex(soup, 0.9, 0.5, 1);
  add_vertex(soup, 0.5, 0.9, 1);
  add_triangle(soup, 9, 10, 11);
  pairs = find(soup, 10);
  assert_int_equal(pairs.count, 1);
  assert_int_equal(pairs.pairs[0].first, 0);
  assert_int_equal(pairs.pairs[0].second, 2);
  vxm_free(context, pairs.pairs);
  vxm_soup_destroy(soup);
}

static void at_most(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  vxm_rng rng = {7};
  for (uint32_t f = 0; f < 40; f++) {
    for (int v = 0; v < 3; v++)
      add_vertex(soup, vxm_rng_unit(&rng), vxm_rng_unit(&rng), vxm_rng_unit(&rng));
    add_triangle(soup, 3 * f, 3 * f + 1, 3 * f + 2);
  }
  vxm_face_pairs all = find(soup, SIZE_MAX);
  assert_true(all.complete && all.count > 20);
  for (size_t most = 0; most <= all.count + 1; most += most < 3 ? 1 : all.count - 2) {
    vxm_face_pairs some = find(soup, most);
    assert_int_equal(some.count, most < all.count ? most : all.count);
    assert_int_equal(some.complete, most >= all.count);
    for (size_t i = 0, j = 0; i < some.count; i++) {
      while (memcmp(&all.pairs[j], &some.pairs[i], sizeof some.pairs[i]) != 0)
        assert_true(++j < all.count);
    }
    vxm_free(context, some.pairs);
  }
  vxm_free(context, all.pairs);
  vxm_soup_destroy(soup);
}

static void nothing_to_find(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  vxm_face_pairs pairs = find(soup, 10);
  assert_true(pairs.count == 0 && pairs.complete);
  vxm_free(context, pairs.pairs);
  /* faces of fewer than three corners, and such that repeat one */
  add_vertex(soup, 0, 0, 0);
  add_vertex(soup, 1, 0, 0);
  add_vertex(soup, 0, -0.0, 0);
  add_face(soup, (const uint32_t[]){0}, 0);
  add_face(soup, (const uint32_t[]){0, 1}, 2);
  add_triangle(soup, 0, 1, 0);
  add_triangle(soup, 0, 1, 2);
  pairs = find(soup, 10);
  assert_true(pairs.count == 0 && pairs.complete);
  vxm_free(context, pairs.pairs);
  vxm_soup_destroy(soup);
}

static void not_finite(void **state) {
  (void)state;
  const double bad[2] = {NAN, INFINITY};
  for (int i = 0; i < 2; i++) {
    vxm_soup *soup = new_soup(context), *out;
    add_cuboid(soup, 0, 0, 0, 1, 1, 1);
    soup->positions[4] = bad[i];
    vxm_error error = VXM_ERROR_INIT;
    vxm_face_pairs pairs;
    int64_t filled, left, turned;
    assert_int_equal(cgal->self_intersections(&pairs, soup, 10, &error), VXM_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "vertex 1 is not finite"));
    assert_int_equal(cgal->fill(&out, NULL, &filled, &left, soup, 0, NULL), VXM_ERROR_ARGUMENT);
    assert_int_equal(cgal->unite(&out, NULL, NULL, soup, NULL, NULL), VXM_ERROR_ARGUMENT);
    assert_int_equal(cgal->orient(&out, &turned, soup, NULL), VXM_ERROR_ARGUMENT);
    assert_int_equal(cgal->wrap(&out, NULL, soup, 0.1, 0.1, NULL), VXM_ERROR_ARGUMENT);
    assert_null(out);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  if (!open_cgal())
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(soups_agree_with_the_oracle),
      cmocka_unit_test(far_from_the_origin),
      cmocka_unit_test(polygons),
      cmocka_unit_test(at_most),
      cmocka_unit_test(nothing_to_find),
      cmocka_unit_test(not_finite),
  };
  return cmocka_run_group_tests(tests, hold_context, release_context);
}
