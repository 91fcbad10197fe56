/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/near_vertices.h"
#include "mesh/vertex_net.h"

#include <math.h>

enum { N_MAX = 4000 };

typedef struct cloud {
  double positions[3 * N_MAX];
  uint8_t roles[N_MAX];
  uint32_t map[N_MAX];
  size_t count;
} cloud;

static cloud the_cloud;

static double distance(const cloud *c, size_t u, size_t v) {
  double sum = 0;
  for (int axis = 0; axis < 3; axis++) {
    double along = c->positions[3 * u + (size_t)axis] - c->positions[3 * v + (size_t)axis];
    sum += along * along;
  }
  return sqrt(sum);
}

static bool is_member(const cloud *c, size_t v) {
  return c->roles[v] == VXM_NEAR_MEMBER;
}

static void weld(vxm_context *context, cloud *c, double tolerance) {
  assert_int_equal(
      vxm_near_vertices_group(context, c->positions, c->count, c->roles, tolerance, c->map, NULL), VXM_OK);
}

/** The groups of the definition, by comparing all pairs over and over. */
static void weld_by_pairs(const cloud *c, double tolerance, uint32_t *map) {
  static uint32_t label[N_MAX];
  for (uint32_t v = 0; v < c->count; v++)
    label[v] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t u = 0; u < c->count; u++)
      for (size_t v = 0; v < u; v++)
        if (is_member(c, u) && is_member(c, v) && label[u] != label[v] && distance(c, u, v) <= tolerance) {
          label[u] = label[v] = label[u] < label[v] ? label[u] : label[v];
          changed = true;
        }
  }
  for (uint32_t v = 0; v < c->count; v++) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0;
    bool blocked = false;
    for (size_t u = 0; u < c->count; u++) {
      if (label[u] != label[v])
        continue;
      for (int axis = 0; axis < 3; axis++) {
        low[axis] = fmin(low[axis], c->positions[3 * u + (size_t)axis]);
        high[axis] = fmax(high[axis], c->positions[3 * u + (size_t)axis]);
      }
      for (size_t o = 0; o < c->count; o++)
        blocked |= c->roles[o] == VXM_NEAR_OBSTACLE && distance(c, u, o) <= tolerance;
    }
    for (int axis = 0; axis < 3; axis++)
      sum += (high[axis] - low[axis]) * (high[axis] - low[axis]);
    map[v] = sqrt(sum) <= tolerance && !blocked && is_member(c, v) ? label[v] : v;
  }
}

static void equals_all_pairs(void **state) {
  (void)state;
  cloud *c = &the_cloud;
  vxm_rng rng = {21};
  for (int round = 0; round < 150; round++) {
    vxm_context *context = context_of_threads(1 + round % 3);
    c->count = (size_t)vxm_rng_below(&rng, 90);
    /* some points, and others near them; coordinates of 1/1024 keep distances exact enough to compare */
    for (size_t v = 0; v < c->count; v++) {
      size_t like = v > 0 && vxm_rng_below(&rng, 3) ? (size_t)vxm_rng_below(&rng, v) : v;
      for (size_t axis = 0; axis < 3; axis++) {
        double step = (double)vxm_rng_below(&rng, 65) / 1024 - 0x1p-5;
        c->positions[3 * v + axis] =
            like == v ? (double)vxm_rng_below(&rng, 1024) / 1024 - 0.5 : c->positions[3 * like + axis] + step;
      }
      c->roles[v] = vxm_rng_below(&rng, 8) ? VXM_NEAR_MEMBER
                                           : (vxm_rng_below(&rng, 2) ? VXM_NEAR_OBSTACLE : VXM_NEAR_ABSENT);
    }
    static uint32_t wanted[N_MAX];
    double tolerance = 0.0225 * (1 + (double)vxm_rng_below(&rng, 3));
    weld(context, c, tolerance);
    weld_by_pairs(c, tolerance, wanted);
    assert_memory_equal(c->map, wanted, c->count * sizeof *wanted);
    vxm_context_destroy(context);
  }
}

/** The same where most vertices are obstacles far from all members, and some stand in their way. */
static void few_members_among_many(void **state) {
  (void)state;
  cloud *c = &the_cloud;
  vxm_rng rng = {22};
  size_t merged = 0, blocked = 0;
  for (int round = 0; round < 60; round++) {
    vxm_context *context = context_of_threads(1 + round % 3);
    c->count = 100 + (size_t)vxm_rng_below(&rng, 200);
    bool flat = vxm_rng_below(&rng, 4) == 0;
    for (size_t v = 0; v < c->count; v++) {
      size_t like = v > 0 && vxm_rng_below(&rng, 2) ? (size_t)vxm_rng_below(&rng, v) : v;
      for (size_t axis = 0; axis < 3; axis++) {
        double step = ((double)vxm_rng_below(&rng, 7) - 3) / 8192;
        c->positions[3 * v + axis] =
            like == v ? (double)vxm_rng_below(&rng, 1024) / 1024 - 0.5 : c->positions[3 * like + axis] + step;
        if (flat && axis == 1)
          c->positions[3 * v + axis] = 0.25;
      }
      c->roles[v] = vxm_rng_below(&rng, 6) ? VXM_NEAR_OBSTACLE : VXM_NEAR_MEMBER;
      if (like != v && is_member(c, like) && vxm_rng_below(&rng, 4))
        c->roles[v] = VXM_NEAR_MEMBER;
    }
    static uint32_t wanted[N_MAX];
    double tolerance = 0.00047 * (1 + (double)vxm_rng_below(&rng, 3));
    weld(context, c, tolerance);
    weld_by_pairs(c, tolerance, wanted);
    assert_memory_equal(c->map, wanted, c->count * sizeof *wanted);
    for (size_t v = 0; v < c->count; v++)
      for (size_t u = 0; u < v; u++)
        if (is_member(c, u) && is_member(c, v) && distance(c, u, v) <= tolerance) {
          merged += c->map[u] == c->map[v];
          blocked += c->map[u] != c->map[v];
        }
    vxm_context_destroy(context);
  }
  assert_true(merged > 50 && blocked > 50);
}

/** What holds for any input: nothing farther apart than the tolerance, and merged groups are by themselves.
 */
static void check_promises(const cloud *c, double tolerance) {
  for (size_t u = 0; u < c->count; u++) {
    assert_true(c->map[u] <= u);
    assert_int_equal(c->map[c->map[u]], c->map[u]);
    if (!is_member(c, u)) {
      assert_int_equal(c->map[u], u);
      continue;
    }
    for (size_t v = 0; v < u; v++) {
      if (c->roles[v] == VXM_NEAR_ABSENT)
        continue;
      double d = distance(c, u, v);
      bool merged = c->map[u] != u || c->map[v] != v;
      if (c->map[u] == c->map[v])
        assert_true(d <= tolerance * (1 + 1e-12));
      else if (merged && is_member(c, v) && d < tolerance * (1 - 1e-12)) {
        /* one of them is merged with others, yet the two are near and apart */
        bool group_of_u = false, group_of_v = false;
        for (size_t w = 0; w < c->count; w++) {
          group_of_u |= w != u && c->map[w] == c->map[u];
          group_of_v |= w != v && c->map[w] == c->map[v];
        }
        assert_false(group_of_u || group_of_v);
      }
    }
  }
}

static void crowds_keep_the_promises(void **state) {
  (void)state;
  static const double spreads[] = {0.3, 1, 4, 12, 60};
  cloud *c = &the_cloud;
  vxm_rng rng = {4};
  uint32_t first[N_MAX];
  for (size_t i = 0; i < sizeof spreads / sizeof *spreads; i++)
    for (int threads = 1; threads <= 7; threads += 3) {
      vxm_rng same = rng;
      vxm_context *context = context_of_threads(threads);
      c->count = 1500;
      for (size_t v = 0; v < c->count; v++) {
        for (size_t axis = 0; axis < 3; axis++)
          c->positions[3 * v + axis] = spreads[i] * (vxm_rng_unit(&same) - 0.5) / sqrt(3.0);
        c->roles[v] = vxm_rng_below(&same, 16) || i == 0 ? VXM_NEAR_MEMBER : VXM_NEAR_OBSTACLE;
      }
      weld(context, c, 1.0);
      check_promises(c, 1.0);
      if (threads == 1)
        memcpy(first, c->map, c->count * sizeof *first);
      assert_memory_equal(c->map, first, c->count * sizeof *first);
      /* a ball within the tolerance becomes one vertex however many there are */
      for (size_t v = 0; i == 0 && v < c->count; v++)
        assert_int_equal(c->map[v], 0);
      vxm_context_destroy(context);
    }
}

static void pairs_of_any_size(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  static const double scales[] = {1e-300, 1e-160, 1e-20, 1, 1e20, 1e160, 1e300};
  for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
    cloud *c = &the_cloud;
    double s = scales[i];
    c->count = 6;
    const double positions[6][3] = {{0, 0, 0},       {0.9 * s, 0, 0}, {5 * s, 0, 0},
                                    {6.1 * s, 0, 0}, {0, 70 * s, 0},  {0, 70 * s, -s}};
    memcpy(c->positions, positions, sizeof positions);
    memset(c->roles, VXM_NEAR_MEMBER, 6);
    weld(context, c, s);
    static const uint32_t wanted[6] = {0, 0, 2, 3, 4, 4};
    assert_memory_equal(c->map, wanted, sizeof wanted);
    /* a chain is left alone, an obstacle keeps its neighbours apart, no tolerance merges nothing */
    c->positions[6] = 1.8 * s;
    c->roles[4] = VXM_NEAR_OBSTACLE;
    weld(context, c, s);
    for (uint32_t v = 0; v < 6; v++)
      assert_int_equal(c->map[v], v);
    /* an obstacle near one member of a group keeps all of it apart */
    c->positions[6] = 1.8 * s;
    c->roles[2] = VXM_NEAR_OBSTACLE;
    weld(context, c, s);
    assert_int_equal(c->map[1], 1);
    c->roles[2] = VXM_NEAR_ABSENT;
    weld(context, c, s);
    assert_int_equal(c->map[1], 0);
    weld(context, c, 0);
    for (uint32_t v = 0; v < 6; v++)
      assert_int_equal(c->map[v], v);
  }
  vxm_context_destroy(context);
}

/** A tolerance so small that cells are beyond what integers hold, and one so large that all is one cell. */
static void cells_beyond_integers(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  cloud *c = &the_cloud;
  c->count = 4;
  const double positions[4][3] = {{1e300, 1, 0}, {1e300, 1 + 0x1p-52, 0}, {-1e300, 1, 0}, {0, 0, 1}};
  memcpy(c->positions, positions, sizeof positions);
  memset(c->roles, VXM_NEAR_MEMBER, 4);
  weld(context, c, 0x1p-51);
  static const uint32_t pair[4] = {0, 0, 2, 3};
  assert_memory_equal(c->map, pair, sizeof pair);
  weld(context, c, 0x1p-1074);
  static const uint32_t none[4] = {0, 1, 2, 3};
  assert_memory_equal(c->map, none, sizeof none);
  weld(context, c, 1e301);
  static const uint32_t all[4] = {0, 0, 0, 0};
  assert_memory_equal(c->map, all, sizeof all);
  weld(context, c, 1.7e308);
  assert_memory_equal(c->map, all, sizeof all);
  vxm_context_destroy(context);
}

/** Many vertices, also in one place: linear time, or this would take minutes. */
static void many_vertices(void **state) {
  (void)state;
  enum { N = 300000 };
  double *positions = malloc(3 * N * sizeof *positions);
  uint8_t *roles = malloc(N);
  uint32_t *map = malloc(N * sizeof *map);
  assert_non_null(positions);
  assert_non_null(roles);
  assert_non_null(map);
  vxm_context *context = context_of_threads(2);
  vxm_rng rng = {77};
  memset(roles, VXM_NEAR_MEMBER, N);
  for (size_t i = 0; i < 3 * N; i++)
    positions[i] = vxm_rng_unit(&rng) / 2;
  assert_int_equal(vxm_near_vertices_group(context, positions, N, roles, 1.0, map, NULL), VXM_OK);
  for (size_t v = 0; v < N; v++)
    if (map[v] != 0)
      fail_msg("vertex %zu is not merged", v);
  /* dense, and far too wide */
  assert_int_equal(vxm_near_vertices_group(context, positions, N, roles, 0.1, map, NULL), VXM_OK);
  for (size_t v = 0; v < N; v++)
    if (map[v] != v)
      fail_msg("vertex %zu is merged", v);
  vxm_context_destroy(context);
  free(map);
  free(roles);
  free(positions);
}

/** In their order: those that stay are those to which none that stays is near; then the nearest. */
static void net_by_pairs(const cloud *c, double tolerance, uint32_t *map) {
  bool stays[N_MAX] = {false};
  for (size_t v = 0; v < c->count; v++) {
    stays[v] = is_member(c, v);
    for (size_t u = 0; u < v && stays[v]; u++)
      stays[v] = !stays[u] || distance(c, u, v) > tolerance;
  }
  for (size_t v = 0; v < c->count; v++) {
    map[v] = (uint32_t)v;
    for (size_t u = 0; u < c->count && is_member(c, v) && !stays[v]; u++)
      if (stays[u] && distance(c, u, v) <= tolerance &&
          (map[v] == v || distance(c, u, v) < distance(c, map[v], v)))
        map[v] = (uint32_t)u;
  }
}

static void net_equals_all_pairs(void **state) {
  (void)state;
  cloud *c = &the_cloud;
  vxm_rng rng = {23};
  vxm_context *context = context_of_threads(1);
  static uint32_t wanted[N_MAX];
  size_t later = 0;
  for (int round = 0; round < 200; round++) {
    c->count = (size_t)vxm_rng_below(&rng, 300);
    double size = ldexp(1.0, (int)vxm_rng_below(&rng, 1800) - 900);
    for (size_t v = 0; v < c->count; v++) {
      for (size_t axis = 0; axis < 3; axis++)
        c->positions[3 * v + axis] = size * (double)vxm_rng_below(&rng, 1024);
      c->roles[v] = vxm_rng_below(&rng, 8) ? VXM_NEAR_MEMBER : VXM_NEAR_ABSENT;
      c->map[v] = (uint32_t)v;
    }
    /* squares of whole numbers are never equal to this, so that rounding decides nothing */
    double tolerance = size * (0.5 + sqrt(0.5 + (double)vxm_rng_below(&rng, 60000)));
    for (size_t i = 0; i < 3 * c->count; i++)
      c->positions[i] /= size;
    net_by_pairs(c, tolerance / size, wanted);
    for (size_t i = 0; i < 3 * c->count; i++)
      c->positions[i] *= size;
    assert_int_equal(vxm_vertex_net(context, c->positions, c->count, c->roles, tolerance, c->map, NULL),
                     VXM_OK);
    assert_memory_equal(c->map, wanted, c->count * sizeof *wanted);
    for (size_t v = 0; v < c->count; v++)
      later += c->map[v] > v;
  }
  assert_true(later > 100);
  vxm_context_destroy(context);
}

/** After the groups: these stay as they are, and nothing near is left. */
static void net_after_groups(void **state) {
  (void)state;
  cloud *c = &the_cloud;
  vxm_rng rng = {24};
  vxm_context *context = context_of_threads(2);
  static uint32_t groups[N_MAX];
  size_t merged = 0;
  for (int round = 0; round < 40; round++) {
    c->count = 1 + (size_t)vxm_rng_below(&rng, N_MAX);
    for (size_t i = 0; i < 3 * c->count; i++)
      c->positions[i] = 12 * vxm_rng_unit(&rng);
    memset(c->roles, VXM_NEAR_MEMBER, c->count);
    double tolerance = 0.1 + 0.1 * round;
    weld(context, c, tolerance);
    memcpy(groups, c->map, c->count * sizeof *groups);
    assert_int_equal(vxm_vertex_net(context, c->positions, c->count, c->roles, tolerance, c->map, NULL),
                     VXM_OK);
    for (size_t v = 0; v < c->count; v++) {
      assert_true(groups[v] == v || c->map[v] == groups[v]);
      assert_int_equal(c->map[c->map[v]], c->map[v]);
      assert_true(distance(c, v, c->map[v]) <= tolerance * (1 + 1e-12));
      merged += groups[v] != v;
      for (size_t u = 0; u < v && c->map[v] == v; u++)
        assert_true(c->map[u] != u || distance(c, u, v) > tolerance * (1 - 1e-12));
    }
  }
  assert_true(merged > 100);
  vxm_context_destroy(context);
}

/** Columns beyond what integers hold, a tolerance beyond what numbers can be divided by, and crowds. */
static void net_at_extremes(void **state) {
  (void)state;
  cloud *c = &the_cloud;
  vxm_context *context = context_of_threads(1);
  c->count = N_MAX;
  for (size_t v = 0; v < N_MAX; v++) {
    memcpy(c->positions + 3 * v, (double[3]){1e300, v % 2 ? 1e300 * (1 + (double)v) : -1, (double)v},
           3 * sizeof(double));
    c->roles[v] = VXM_NEAR_MEMBER;
  }
  static const double tolerances[] = {0x1p-1074, 0.5, 1.7e308};
  static const bool all[] = {false, false, true};
  for (int i = 0; i < 3; i++) {
    for (size_t v = 0; v < N_MAX; v++)
      c->map[v] = (uint32_t)v;
    assert_int_equal(vxm_vertex_net(context, c->positions, N_MAX, c->roles, tolerances[i], c->map, NULL),
                     VXM_OK);
    for (size_t v = 0; v < N_MAX; v++)
      assert_int_equal(c->map[v], all[i] ? 0 : v);
  }
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equals_all_pairs),         cmocka_unit_test(few_members_among_many),
      cmocka_unit_test(crowds_keep_the_promises), cmocka_unit_test(pairs_of_any_size),
      cmocka_unit_test(cells_beyond_integers),    cmocka_unit_test(many_vertices),
      cmocka_unit_test(net_equals_all_pairs),     cmocka_unit_test(net_after_groups),
      cmocka_unit_test(net_at_extremes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
