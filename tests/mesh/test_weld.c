/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/weld.h"

#include <math.h>

/** First vertex of the same position by looking at all earlier ones. */
static uint32_t first_same(const double *positions, uint32_t v) {
  const double *p = positions + 3 * (size_t)v;
  for (uint32_t u = 0; u < v; u++) {
    const double *q = positions + 3 * (size_t)u;
    if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
      return u;
  }
  return v;
}

static double strange_coordinate(vxm_rng *rng) {
  static const double values[] = {0.0, -0.0,      1.0, -1.0,  INFINITY, -INFINITY,
                                  NAN, 0x1p-1074, 0.1, 1e300, -0x1p-3,  0x1.0000000001p0};
  return values[vxm_rng_below(rng, sizeof values / sizeof *values)];
}

static void weld_equals_search(void **state) {
  (void)state;
  vxm_rng rng = {5};
  vxm_context *context = context_of_threads(2);
  for (int round = 0; round < 60; round++) {
    enum { N = 700 };
    static double positions[3 * N];
    static uint32_t map[N];
    size_t count = (size_t)vxm_rng_below(&rng, N + 1), distinct, wanted = 0;
    for (size_t i = 0; i < 3 * count; i++)
      positions[i] = round % 2 ? strange_coordinate(&rng) : (double)vxm_rng_below(&rng, 6);
    assert_int_equal(vxm_weld_exact(context, positions, count, map, &distinct, NULL), VXM_OK);
    for (uint32_t v = 0; v < count; v++) {
      assert_int_equal(map[v], first_same(positions, v));
      wanted += map[v] == v;
    }
    assert_int_equal(distinct, wanted);
  }
  vxm_context_destroy(context);
}

static void crowds_and_threads(void **state) {
  (void)state;
  enum { N = 300000 };
  double *positions = calloc(3 * N, sizeof *positions);
  uint32_t *map = malloc(N * sizeof *map), *first = malloc(N * sizeof *first);
  assert_non_null(positions);
  assert_non_null(map);
  assert_non_null(first);
  static const int threads[3] = {1, 2, 7};
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of_threads(threads[t]);
    size_t distinct;
    /* all at one place */
    memset(positions, 0, 3 * N * sizeof *positions);
    assert_int_equal(vxm_weld_exact(context, positions, N, map, &distinct, NULL), VXM_OK);
    assert_int_equal(distinct, 1);
    for (size_t v = 0; v < N; v++)
      assert_int_equal(map[v], 0);
    /* each place several times */
    vxm_rng rng = {8};
    for (size_t i = 0; i < 3 * N; i++)
      positions[i] = (double)vxm_rng_below(&rng, 40) * 0.1;
    assert_int_equal(vxm_weld_exact(context, positions, N, map, &distinct, NULL), VXM_OK);
    assert_true(distinct > 60000 && distinct <= 64000);
    if (t == 0)
      memcpy(first, map, N * sizeof *map);
    assert_memory_equal(map, first, N * sizeof *map);
    vxm_context_destroy(context);
  }
  free(first);
  free(map);
  free(positions);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(weld_equals_search),
      cmocka_unit_test(crowds_and_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
