/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons into triangles: exact, whatever touches what; and fast. */
#include "../base/rounds.h"
#include "mesh/orient2d.h"
#include "mesh/triangulate.h"
#include "polygons.h"

#include "base/bits.h"

#include <stdlib.h>

static vxm_context *context;

static int setup(void **state) {
  (void)state;
  return vxm_context_create(&context, NULL, NULL) != VXM_OK;
}

static int teardown(void **state) {
  (void)state;
  vxm_context_destroy(context);
  return 0;
}

/* ---- The predicate ---- */

static int turn_of(const int64_t a[2], const int64_t b[2], const int64_t c[2]) {
  vxm_int128 area = (vxm_int128)(b[0] - a[0]) * (c[1] - a[1]) - (vxm_int128)(b[1] - a[1]) * (c[0] - a[0]);
  return area > 0 ? 1 : area < 0 ? -1 : 0;
}

/** All but in line, with as many digits as a double has, scaled up and down. */
static void test_turn(void **state) {
  (void)state;
  vxm_rng rng = {41};
  int zeros = 0;
  for (int round = 0; round < ROUNDS(200000); round++) {
    int64_t p[3][2], range = INT64_C(1) << (2 + round % 50);
    for (int c = 0; c < 2; c++) {
      int64_t from = (int64_t)vxm_rng_below(&rng, (uint64_t)range);
      int64_t along = (int64_t)vxm_rng_below(&rng, (uint64_t)range) / 4;
      for (int i = 0; i < 3; i++)
        p[i][c] = from + along * (i == 2 ? (int64_t)(round % 3) : i);
    }
    if (round % 5)
      p[round % 3][round % 2] += (int64_t)vxm_rng_below(&rng, 3) - 1;
    double scale = ldexp(1, round % 41 - 20), at[3][2];
    for (int i = 0; i < 3; i++)
      for (int c = 0; c < 2; c++)
        at[i][c] = (double)p[i][c] * scale;
    int right = turn_of(p[0], p[1], p[2]);
    zeros += right == 0;
    assert_int_equal(vxm_orient2d(at[0], at[1], at[2]), right);
    assert_int_equal(vxm_orient2d_exact(at[0], at[1], at[2]), right);
  }
  assert_true(zeros > 1000);
}

/* ---- Polygons ---- */

static int compare_edges(const void *a, const void *b) {
  return memcmp(a, b, 2 * sizeof(uint32_t));
}

/** The triangles' boundary is the polygon's: taking out pairs that run both ways leaves nothing. */
static void expect_boundary(const uint32_t *triangles, size_t n) {
  size_t count = 3 * (n - 2) + n;
  uint32_t(*forth)[2] = malloc(count * sizeof *forth), (*back)[2] = malloc(count * sizeof *back);
  for (size_t t = 0; t < n - 2; t++)
    for (size_t k = 0; k < 3; k++) {
      forth[3 * t + k][0] = triangles[3 * t + k];
      forth[3 * t + k][1] = triangles[3 * t + (k + 1) % 3];
    }
  for (size_t i = 0; i < n; i++) {
    forth[3 * (n - 2) + i][0] = (uint32_t)((i + 1) % n);
    forth[3 * (n - 2) + i][1] = (uint32_t)i;
  }
  for (size_t e = 0; e < count; e++) {
    back[e][0] = forth[e][1];
    back[e][1] = forth[e][0];
  }
  qsort(forth, count, sizeof *forth, compare_edges);
  qsort(back, count, sizeof *back, compare_edges);
  assert_memory_equal(forth, back, count * sizeof *forth);
  free(back);
  free(forth);
}

/** In the plane z = u x + v y, the axes in any order, at most some 2^40 from the origin; returns positions.
 */
static double *in_space(const flat *f, vxm_rng *rng) {
  double *positions = malloc(3 * f->n * sizeof *positions);
  int64_t u = (int64_t)vxm_rng_below(rng, 5) - 2, v = (int64_t)vxm_rng_below(rng, 5) - 2;
  int64_t off = vxm_rng_below(rng, 3) ? 0 : INT64_C(1) << vxm_rng_below(rng, 40);
  size_t first = (size_t)vxm_rng_below(rng, 3);
  for (size_t i = 0; i < f->n; i++) {
    double *p = positions + 3 * i;
    p[first] = (double)(f->at[i][0] + off);
    p[(first + 1) % 3] = (double)(f->at[i][1] - off);
    p[(first + 2) % 3] = (double)(u * f->at[i][0] + v * f->at[i][1]);
  }
  return positions;
}

/** No triangle is turned round, so that, together with the boundary, they cover the polygon once and nothing
 * else. */
static void expect_exact(const flat *f, const double *positions, vxm_triangulator *tri) {
  uint32_t *corners = malloc(f->n * sizeof *corners);
  for (size_t i = 0; i < f->n; i++)
    corners[i] = (uint32_t)i;
  const uint32_t *triangles;
  assert_int_equal(vxm_triangulate(tri, positions, corners, f->n, &triangles, NULL), VXM_OK);
  int64_t area = flat_area(f);
  for (size_t t = 0; t < f->n - 2; t++) {
    const uint32_t *c = triangles + 3 * t;
    int64_t part = flat_turn(f->at[c[0]], f->at[c[1]], f->at[c[2]]);
    if (area > 0 ? part < 0 : part > 0)
      fail_msg("triangle %zu of %zu is turned round", t, f->n - 2);
  }
  expect_boundary(triangles, f->n);
  free(corners);
}

static void test_random(void **state) {
  (void)state;
  static flat f;
  vxm_rng rng = {42};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  int made = 0;
  for (int round = 0; round < ROUNDS(6000); round++) {
    if (!flat_random(&f, &rng, round))
      continue;
    flat_map(&f, &rng);
    if (round / 8 % 2)
      flat_reverse(&f);
    double *positions = in_space(&f, &rng);
    expect_exact(&f, positions, &tri);
    free(positions);
    made++;
  }
  assert_true(made > ROUNDS(5000));
  vxm_triangulator_close(&tri);
}

/** A plate with many round holes, joined to each other and to the rim by edges there and back. */
static void test_plate(void **state) {
  (void)state;
  static flat f;
  vxm_rng rng = {43};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (int holes = 1; holes <= 20; holes++) {
    f.n = 0;
    flat_add(&f, 0, 0);
    for (int way = 0; way < 2; way++) /* over all of them, and back below */
      for (int n = 0; n < holes; n++)
        for (int k = 8 * way; k <= 8 + 8 * way; k++) {
          double angle = k * 0.39269908169872414;
          int64_t middle = 1000 + 1000 * (way ? holes - 1 - n : n);
          flat_add(&f, middle - llround(400 * cos(angle)), 600 + llround(400 * sin(angle)));
        }
    flat_add(&f, 0, 0);
    flat_add(&f, 1000 * holes + 1000, 0);
    flat_add(&f, 1000 * holes + 1000, 1200);
    flat_add(&f, 0, 1200);
    double *positions = in_space(&f, &rng);
    expect_exact(&f, positions, &tri);
    free(positions);
  }
  vxm_triangulator_close(&tri);
}

/** What has no room for exactness to save it: the boundary is right, and it ends. */
static void test_crossings(void **state) {
  (void)state;
  static flat f;
  vxm_rng rng = {44};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (int round = 0; round < ROUNDS(3000); round++) {
    f.n = 0;
    size_t n = 4 + (size_t)vxm_rng_below(&rng, round % 100 ? 12 : 300);
    for (size_t i = 0; i < n; i++)
      flat_add(&f, (int64_t)vxm_rng_below(&rng, 8), (int64_t)vxm_rng_below(&rng, 8));
    double *positions = in_space(&f, &rng);
    uint32_t corners[304];
    for (size_t i = 0; i < n; i++)
      corners[i] = (uint32_t)i;
    const uint32_t *triangles;
    assert_int_equal(vxm_triangulate(&tri, positions, corners, n, &triangles, NULL), VXM_OK);
    expect_boundary(triangles, n);
    free(positions);
  }
  vxm_triangulator_close(&tri);
}

/** Very large and very small coordinates. */
static void test_scales(void **state) {
  (void)state;
  static flat f;
  vxm_rng rng = {45};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (int round = 0; round < ROUNDS(300); round++) {
    if (!flat_random(&f, &rng, round))
      continue;
    double *positions = malloc(3 * f.n * sizeof *positions);
    for (size_t i = 0; i < f.n; i++)
      for (size_t c = 0; c < 3; c++)
        positions[3 * i + c] = c == 2 ? 0 : ldexp((double)f.at[i][c], round % 2 ? 1000 : -1000);
    expect_exact(&f, positions, &tri);
    free(positions);
  }
  vxm_triangulator_close(&tri);
}

/** A walk round a tree of edges on a lattice, each there and back. */
static void walk(flat *f, bool met[16][16], int64_t x, int64_t y, vxm_rng *rng) {
  static const int steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  met[y][x] = true;
  flat_add(f, x, y);
  for (int tries = 0; tries < 5; tries++) {
    const int *step = steps[vxm_rng_below(rng, 4)];
    int64_t u = x + step[0], v = y + step[1];
    if (u < 0 || v < 0 || u > 15 || v > 15 || met[v][u] || f->n > 200)
      continue;
    walk(f, met, u, v, rng);
    flat_add(f, x, y);
  }
}

/** Polygons without any area stay so, in whichever plane they lie: triangles are all segments of theirs. */
static void test_no_area(void **state) {
  (void)state;
  static flat f;
  vxm_rng rng = {47};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (int round = 0; round < ROUNDS(2000); round++) {
    bool met[16][16] = {{false}};
    f.n = 0;
    walk(&f, met, 8, 8, &rng);
    f.n--; /* the walk is back where it began */
    if (f.n < 3)
      continue;
    flat_map(&f, &rng);
    double *positions = in_space(&f, &rng);
    uint32_t corners[512];
    for (size_t i = 0; i < f.n; i++)
      corners[i] = (uint32_t)i;
    const uint32_t *triangles;
    assert_int_equal(vxm_triangulate(&tri, positions, corners, f.n, &triangles, NULL), VXM_OK);
    expect_boundary(triangles, f.n);
    for (size_t t = 0; t < f.n - 2; t++) {
      const uint32_t *c = triangles + 3 * t;
      assert_int_equal(flat_turn(f.at[c[0]], f.at[c[1]], f.at[c[2]]), 0);
    }
    free(positions);
  }
  vxm_triangulator_close(&tri);
}

/** A hundred thousand corners and more, of kinds in which ears are long, or looked for in vain. */
static void test_large(void **state) {
  (void)state;
  enum { N = 120000 };
  vxm_rng rng = {46};
  double *positions = malloc(3 * N * sizeof *positions);
  uint32_t *corners = malloc(N * sizeof *corners);
  for (int kind = 0; kind < 6; kind++) {
    vxm_triangulator tri;
    vxm_triangulator_open(&tri, context);
    for (size_t i = 0; i < N; i++) {
      double *p = positions + 3 * i, along = (double)(i < N / 2 ? i : N - 1 - i), radius;
      corners[i] = (uint32_t)i;
      p[2] = 0;
      if (kind == 0) { /* a comb, upside down and back */
        p[0] = (double)(i / 2) + (double)(i % 2) * 0.25;
        p[1] = i % 2 ? 1 : 1e5;
        if (i >= N - 2)
          p[0] = i == N - 2 ? N : -1, p[1] = -1e5;
      } else if (kind == 1) { /* a spiral */
        radius = along * (i < N / 2 ? 1 : 0.9999);
        p[0] = radius * cos(0.001 * along);
        p[1] = radius * sin(0.001 * along);
      } else if (kind == 2) { /* a star */
        radius = 1 + 9 * vxm_rng_unit(&rng);
        p[0] = radius * cos((double)i * 6.283185307179586 / N);
        p[1] = radius * sin((double)i * 6.283185307179586 / N);
      } else if (kind == 3) { /* a rough strip */
        p[0] = along + 0.4 * vxm_rng_unit(&rng);
        p[1] = (i < N / 2 ? 0 : 1) + 0.9 * vxm_rng_unit(&rng);
      } else if (kind == 4) { /* a saw in a half circle: no tooth can be cut off before its neighbours */
        double angle = along * 3.141592653589793 / (N / 2);
        radius = i < N / 2 ? 10 : 9 + 0.9 * (double)(i % 2);
        p[0] = radius * cos(angle);
        p[1] = radius * sin(angle);
      } else { /* a stair: corners in line, and steps */
        p[0] = floor(along / 2);
        p[1] = floor((along + 1) / 2) + (i < N / 2 ? 0 : 1.5);
      }
    }
    const uint32_t *triangles;
    assert_int_equal(vxm_triangulate(&tri, positions, corners, N, &triangles, NULL), VXM_OK);
    if (tri.looks > 600 * (size_t)N) /* a hundredth of all pairs */
      fail_msg("kind %d: %zu looks for each corner", kind, tri.looks / N);
    double area = 0;
    for (size_t i = 1; i + 1 < N; i++) {
      const double *a = positions, *b = a + 3 * i, *c = b + 3;
      area += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }
    size_t wrong = 0;
    for (size_t t = 0; t < N - 2; t++) {
      const uint32_t *c = triangles + 3 * t;
      const double *a = positions;
      wrong += vxm_orient2d(a + 3 * c[0], a + 3 * c[1], a + 3 * c[2]) == (area > 0 ? -1 : 1);
    }
    if (wrong)
      fail_msg("kind %d: %zu triangles are turned round", kind, wrong);
    expect_boundary(triangles, N);
    vxm_triangulator_close(&tri);
  }
  free(corners);
  free(positions);
}

/** Thirty thousand corners anywhere: in time, and with the right boundary. */
static void test_large_crossings(void **state) {
  (void)state;
  enum { N = 30000 };
  vxm_rng rng = {48};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  double *positions = malloc(3 * N * sizeof *positions);
  uint32_t *corners = malloc(N * sizeof *corners);
  for (size_t i = 0; i < N; i++) {
    corners[i] = (uint32_t)i;
    for (size_t c = 0; c < 3; c++)
      positions[3 * i + c] = vxm_rng_unit(&rng);
  }
  size_t budget = tri.looks_left;
  const uint32_t *triangles;
  assert_int_equal(vxm_triangulate(&tri, positions, corners, N, &triangles, NULL), VXM_OK);
  expect_boundary(triangles, N);
  assert_true(tri.looks < 2 * budget);
  vxm_triangulator_close(&tri);
  free(corners);
  free(positions);
}

/* ---- One way to cut, however a polygon lies ---- */

/** The triangles, each with its vertices in order, and all in order. */
static int compare_vertices(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

static int compare_triangles(const void *a, const void *b) {
  return memcmp(a, b, 3 * sizeof(uint32_t));
}

enum { BENT_MOST = 12 };

static void triangles_of(uint32_t out[BENT_MOST][3], vxm_triangulator *tri, const double *positions,
                         const uint32_t *corners, size_t n) {
  const uint32_t *triangles;
  assert_int_equal(vxm_triangulate(tri, positions, corners, n, &triangles, NULL), VXM_OK);
  memcpy(out, triangles, (n - 2) * sizeof *out);
  for (size_t t = 0; t + 2 < n; t++)
    qsort(out[t], 3, sizeof *out[t], compare_vertices);
  qsort(out, n - 2, sizeof *out, compare_triangles);
}

/** Fails unless the same triangles come of a polygon whichever corner it begins with, whichever way it runs,
 * and however it is turned by right angles and mirrored. */
static void expect_one_way(vxm_triangulator *tri, const double positions[BENT_MOST][3], size_t n,
                           bool turned) {
  static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  uint32_t first[BENT_MOST][3], other[BENT_MOST][3], corners[BENT_MOST];
  for (size_t way = 0; way < (turned ? 48 : 1); way++) {
    double at[BENT_MOST][3];
    for (size_t i = 0; i < n; i++)
      for (int a = 0; a < 3; a++)
        at[i][a] = positions[i][orders[way / 8][a]] * (way >> a & 1 ? -1 : 1);
    for (size_t begin = 0; begin < 2 * n; begin++) {
      for (size_t i = 0; i < n; i++)
        corners[i] = (uint32_t)((begin + (begin < n ? i : n - i)) % n);
      triangles_of(way + begin > 0 ? other : first, tri, at[0], corners, n);
      if (way + begin > 0)
        assert_memory_equal(other, first, (n - 2) * sizeof *first);
    }
  }
}

/** Bent polygons, convex or not, some of which cross themselves. */
static void test_bent(void **state) {
  (void)state;
  vxm_rng rng = {48};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (int round = 0; round < ROUNDS(600); round++) {
    double at[BENT_MOST][3], axis[2][3];
    size_t n = round % 2 ? 4 : 4 + (size_t)vxm_rng_below(&rng, BENT_MOST - 3);
    for (int a = 0; a < 3; a++) {
      axis[0][a] = vxm_rng_unit(&rng) - 0.5;
      axis[1][a] = vxm_rng_unit(&rng) - 0.5;
    }
    for (size_t i = 0; i < n; i++) {
      double angle = 6.283185307179586 * (double)i / (double)n, radius = 0.2 + vxm_rng_unit(&rng);
      for (int a = 0; a < 3; a++)
        at[i][a] = radius * (cos(angle) * axis[0][a] + sin(angle) * axis[1][a]) +
                   (round % 4 ? 0.1 : 1) * (vxm_rng_unit(&rng) - 0.5);
    }
    expect_one_way(&tri, (const double(*)[3])at, n, true);
  }
  vxm_triangulator_close(&tri);
}

/** Equal polygons become the same triangles, also where lengths are equal: regular ones, on a lattice. */
static void test_ties(void **state) {
  (void)state;
  static const double octagon[8][2] = {{1, 0}, {2, 0}, {3, 1}, {3, 2}, {2, 3}, {1, 3}, {0, 2}, {0, 1}};
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (int shape = 0; shape < 6; shape++) {
    double at[BENT_MOST][3] = {{0}};
    size_t n = shape < 3 ? 8 : 4;
    for (size_t i = 0; i < n; i++)
      for (int k = 0; k < 2; k++)
        at[i][(shape + k) % 3] = octagon[(8 / n) * i][k];
    expect_one_way(&tri, (const double(*)[3])at, n, false);
  }
  vxm_triangulator_close(&tri);
}

/** Of four corners: the shorter diagonal where both lie inside, else that which does. */
static void test_diagonals(void **state) {
  (void)state;
  static const struct {
    double at[4][3];
    bool second; /**< from corner 1 to corner 3 */
  } cases[] = {
      {{{0, 0, 0}, {2, 0, 1}, {3, 3, 0}, {0, 2, 1}}, true},     /* a convex one, seen from above */
      {{{0, 0, 0}, {3, 0, 4}, {3, 3, 0}, {0, 3, -4}}, false},   /* as long from above, not in space */
      {{{0, 0, 0}, {9, 1, 0}, {3, 3, 0}, {1, 9, 0}}, false},    /* the longer one would lie outside */
      {{{0, 0, 0}, {1, 4, 0}, {0, 5, 0}, {-1, 4, 0}}, true},    /* a kite */
      {{{0, 0, 0}, {1, 4, 0}, {0, 3, 0}, {-1, 4, 0}}, false},   /* an arrow, whose longer one lies inside */
      {{{0, 0, 0}, {4, 0, 0}, {1, 3, 0}, {0.5, 1.5, 0}}, true}, /* a corner in line */
      {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, false},    /* as long: from what is first in space */
      {{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}}, true},
  };
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, context);
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
    for (int scale = -1000; scale <= 1000; scale += 500) {
      double at[4][3];
      uint32_t made[BENT_MOST][3];
      for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
          at[i][a] = ldexp(cases[c].at[i][a], scale);
      triangles_of(made, &tri, at[0], (uint32_t[]){0, 1, 2, 3}, 4);
      if ((made[0][0] == 0 && made[0][1] == 1 && made[0][2] == 3) != cases[c].second)
        fail_msg("case %zu, scale %d", c, scale);
    }
  vxm_triangulator_close(&tri);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_turn),
      cmocka_unit_test(test_random),
      cmocka_unit_test(test_plate),
      cmocka_unit_test(test_scales),
      cmocka_unit_test(test_large),
      cmocka_unit_test(test_no_area),
      cmocka_unit_test(test_large_crossings),
      cmocka_unit_test(test_crossings),
      cmocka_unit_test(test_bent),
      cmocka_unit_test(test_ties),
      cmocka_unit_test(test_diagonals),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
