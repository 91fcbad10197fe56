/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/box_tree.h"

#include <math.h>

/** The next box by number that holds `inner`, by looking at each. */
static uint32_t next_by_all(const double (*boxes)[6], size_t count, const double inner[6], size_t from) {
  for (size_t i = from; i < count; i++) {
    bool within = true;
    for (int a = 0; a < 3; a++)
      within = within && inner[a] >= boxes[i][a] && inner[a + 3] <= boxes[i][a + 3];
    if (within)
      return (uint32_t)i;
  }
  return VXM_NO_BOX;
}

static void random_box(double box[6], vxm_rng *rng, int kind) {
  double scale = kind == 3 ? pow(2, -40 * vxm_rng_unit(rng)) : 1;
  for (int a = 0; a < 3; a++) {
    double at = 2 * vxm_rng_unit(rng) - 1, wide = vxm_rng_unit(rng);
    if (kind == 1) { /* on a coarse lattice: many sides are the same */
      at = floor(4 * at) / 4;
      wide = floor(4 * wide) / 4;
    }
    if (kind == 2) /* about one point */
      at = -0.5 * wide;
    box[a] = scale * at;
    box[a + 3] = scale * (at + wide);
  }
}

static void same_as_looking_at_all(void **state) {
  (void)state;
  enum { MOST = 600, SEARCHES = 200 };
  static double boxes[MOST][6];
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {3};
  size_t found = 0;
  for (int round = 0; round < 120; round++) {
    int kind = round % 4;
    size_t count = round < 40 ? (size_t)round + 1 : 1 + (size_t)vxm_rng_below(&rng, MOST);
    for (size_t i = 0; i < count; i++)
      random_box(boxes[i], &rng, kind);
    vxm_box_tree tree;
    assert_int_equal(vxm_box_tree_build(&tree, context, (const double(*)[6])boxes, count, NULL), VXM_OK);
    for (int s = 0; s < SEARCHES; s++) {
      double inner[6];
      random_box(inner, &rng, kind);
      if (s % 2)
        memcpy(inner, boxes[vxm_rng_below(&rng, (uint32_t)count)], sizeof inner);
      size_t from = s % 3 ? 0 : (size_t)vxm_rng_below(&rng, (uint32_t)count + 1);
      vxm_box_tree_search(&tree, inner, from);
      for (uint32_t expected = 0; expected != VXM_NO_BOX; from = (size_t)expected + 1, found++) {
        expected = next_by_all((const double(*)[6])boxes, count, inner, from);
        assert_int_equal(vxm_box_tree_next(&tree), expected);
      }
    }
    vxm_box_tree_destroy(&tree);
  }
  assert_true(found > 100000);
  vxm_context_destroy(context);
}

/** What a search for each box looks at on average until the first box that comes after it, for `count` boxes
 * of a kind. */
static double looked_at(int kind, size_t count) {
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {9};
  double(*boxes)[6] = malloc(count * sizeof *boxes);
  assert_non_null(boxes);
  for (size_t i = 0; i < count; i++) {
    double z = 2 * ((double)i + 0.5) / (double)count - 1, turn = 2.399963 * (double)i;
    const double spoke[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
    for (int a = 0; a < 3; a++) {
      double at = vxm_rng_unit(&rng), half = (double)(i + 1) / (double)count;
      boxes[i][a] = kind == 0 ? fmin(spoke[a], 0) - 1e-6 : kind == 1 ? at : kind == 2 ? -half : -1;
      boxes[i][a + 3] = kind == 0 ? fmax(spoke[a], 0) + 1e-6 : kind == 1 ? at + 1e-3 : kind == 2 ? half : 1;
    }
  }
  vxm_box_tree tree;
  assert_int_equal(vxm_box_tree_build(&tree, context, (const double(*)[6])boxes, count, NULL), VXM_OK);
  for (size_t i = 0; i < count; i++) {
    vxm_box_tree_search(&tree, boxes[i], i + 1);
    (void)vxm_box_tree_next(&tree);
  }
  double each = (double)tree.looked_at / (double)count;
  vxm_box_tree_destroy(&tree);
  free(boxes);
  vxm_context_destroy(context);
  return each;
}

/** Spokes about one point, all over space, one in the other, and all the same. */
static void searches_look_at_few(void **state) {
  (void)state;
  static const char *const kinds[] = {"spokes", "scattered", "nested", "alike"};
  for (int kind = 0; kind < 4; kind++) {
    double few = looked_at(kind, 4000), many = looked_at(kind, 64000);
    print_message("%s: %.0f nodes and boxes of 4000, %.0f of 64000\n", kinds[kind], few, many);
    assert_true(many < 400 && many < 3 * few);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_as_looking_at_all),
      cmocka_unit_test(searches_look_at_few),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
