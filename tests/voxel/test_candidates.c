/* SPDX-License-Identifier: BSD-3-Clause */
/** The nearest triangles of points that lie together, found among candidates, are those that the tree finds
 * for each alone, to the bit: of equally near ones that with the lowest number. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/rng.h"
#include "voxel/closest/surface_tree.h"

#include <math.h>
#include <string.h>

enum { MOST = 3000 };

static double corners[MOST][3][3];

static void take(double out[3][3], size_t triangle, const void *payload) {
  (void)payload;
  memcpy(out, corners[triangle], sizeof corners[triangle]);
}

/** Kinds of soups: small triangles on a sphere and in a cloud, large ones, needles and points, and corners on
 * a lattice, where many are equally near. */
enum { KINDS = 5 };

static double wander(vxm_rng *rng, double size) {
  return (vxm_rng_unit(rng) - 0.5) * size;
}

static void make_triangle(double out[3][3], int kind, vxm_rng *rng) {
  double middle[3], size = kind == 2 ? 30 : kind == 3 ? 1e-9 : 0.8, length = 0;
  for (int a = 0; a < 3; a++) {
    middle[a] = wander(rng, 20);
    length += middle[a] * middle[a];
  }
  for (int a = 0; a < 3; a++)
    middle[a] *= kind == 0 ? 10 / sqrt(length) : 1;
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++) {
      out[c][a] = middle[a] + wander(rng, size) + (kind == 3 && c == 2 && a == 0 ? 2 : 0);
      if (kind == 4)
        out[c][a] = floor(out[c][a]);
    }
  if (kind == 3 && vxm_rng_below(rng, 4) == 0)
    memcpy(out[1], out[0], sizeof out[0]);
}

static void assert_same(const vxm_surface_hit *a, const vxm_surface_hit *b) {
  assert_int_equal(a->triangle, b->triangle);
  assert_int_equal(a->place, b->place);
  assert_memory_equal(a->foot, b->foot, sizeof a->foot);
}

static void point_near(double out[3], const double centre[3], double radius, vxm_rng *rng) {
  double off[3], length = 0;
  for (int a = 0; a < 3; a++) {
    off[a] = wander(rng, 2);
    length += off[a] * off[a];
  }
  for (int a = 0; a < 3; a++)
    out[a] = centre[a] + off[a] * radius * (1 - 1e-9) / fmax(sqrt(length), 1);
}

/** Points within a ball, and within one inside it. @return whether they had candidates */
static bool look_in_balls(const vxm_surface_tree *tree, double scale, double shift, vxm_rng *rng) {
  static vxm_surface_candidates outer, inner;
  double centre[3], within[3], p[3], radius = (0.1 + 3 * vxm_rng_unit(rng)) * scale;
  uint32_t near = 0;
  for (int a = 0; a < 3; a++)
    centre[a] = wander(rng, 24) * scale + shift;
  if (!vxm_surface_candidates_gather(&outer, tree, centre, radius, &near))
    return false;
  point_near(within, centre, radius / 2, rng);
  bool is_narrowed = vxm_surface_candidates_narrow(&inner, &outer, within, radius / 2, &near);
  assert_true(!is_narrowed || inner.count <= outer.count);
  for (int i = 0; i < 12; i++) {
    bool is_inner = i % 2 && is_narrowed;
    point_near(p, is_inner ? within : centre, is_inner ? radius / 2 : radius, rng);
    const vxm_surface_hit one = vxm_surface_tree_nearest(tree, p, 0),
                          other = vxm_surface_candidates_nearest(is_inner ? &inner : &outer, p, near);
    assert_same(&one, &other);
    near = other.place;
  }
  return true;
}

static void test_candidates(void **unused) {
  (void)unused;
  static const double scales[] = {1, 1e-30, 1e30, 1e-3, 1e5}, shifts[] = {0, 0, 0, 1e3, -7e9};
  vxm_context *context;
  vxm_rng rng = {17};
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  for (int round = 0; round < 60; round++) {
    const size_t count = round % 4 == 0 ? 1 + vxm_rng_below(&rng, 9) : 1 + vxm_rng_below(&rng, MOST);
    const double scale = scales[round / KINDS % 5], shift = shifts[round / KINDS % 5];
    vxm_surface_tree *tree;
    int gathered = 0;
    for (size_t t = 0; t < count; t++) {
      make_triangle(corners[t], round % KINDS, &rng);
      for (int c = 0; c < 9; c++)
        corners[t][c / 3][c % 3] = corners[t][c / 3][c % 3] * scale + shift;
    }
    assert_int_equal(vxm_surface_tree_create(&tree, context, count, take, NULL, NULL), VXM_OK);
    for (int ball = 0; ball < 60; ball++)
      gathered += look_in_balls(tree, scale, shift, &rng);
    assert_true(gathered > 0 || round % KINDS == 0 || round % KINDS == 2 || fabs(shift) > 1e4 * scale);
    vxm_surface_tree_destroy(tree);
  }
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_candidates)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
