/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The distance to a triangle against exact integers; the tree, in all builds, against that distance asked of
 * every triangle, to the bit.
 */
#include "../base/rounds.h"
#include "distance_triangles.h"
#include "shapes.h"

#include "base/bits.h"
#include "base/rng.h"
#include "voxel/closest/distance_bvh.h"
#include "voxel/closest/triangle_distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void corners_of(double out[3][3], size_t triangle, const void *payload) {
  memcpy(out, ((const triangle_corners *)payload)[triangle], sizeof(triangle_corners));
}

/* ---- The exact distance: integers up to 2^21 ---- */

typedef struct vec {
  vxm_int128 at[3];
} vec;

static vec sub(vec a, vec b) {
  return (vec){{a.at[0] - b.at[0], a.at[1] - b.at[1], a.at[2] - b.at[2]}};
}

static vec cross(vec a, vec b) {
  return (vec){{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
                a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}

static vxm_int128 dot(vec a, vec b) {
  return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}

static long double segment_distance(vec p, vec a, vec b) {
  vec ab = sub(b, a), ap = sub(p, a), bp = sub(p, b);
  if (dot(ap, ab) <= 0)
    return sqrtl((long double)dot(ap, ap));
  if (dot(bp, ab) >= 0)
    return sqrtl((long double)dot(bp, bp));
  vec c = cross(ap, ab);
  return sqrtl((long double)dot(c, c) / (long double)dot(ab, ab));
}

static long double triangle_distance(vec p, const vec corner[3]) {
  vec n = cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]));
  long double least = INFINITY;
  bool is_inside = dot(n, n) > 0;
  for (int e = 0; e < 3; e++) {
    vec a = corner[e], b = corner[(e + 1) % 3];
    is_inside = is_inside && dot(cross(sub(b, a), sub(p, a)), n) >= 0;
    long double distance = segment_distance(p, a, b);
    least = distance < least ? distance : least;
  }
  if (!is_inside)
    return least;
  vxm_int128 height = dot(n, sub(p, corner[0]));
  return (long double)(height < 0 ? -height : height) / sqrtl((long double)dot(n, n));
}

/** Of all sizes, near and far, slivers, segments and points, along axes and not. */
static void random_triangle(vec corner[3], vxm_rng *rng) {
  int64_t size = INT64_C(1) << vxm_rng_below(rng, 21), place = INT64_C(1) << vxm_rng_below(rng, 20);
  int kind = (int)vxm_rng_below(rng, 6);
  vec from, along;
  for (int a = 0; a < 3; a++) {
    from.at[a] = (int64_t)vxm_rng_below(rng, (uint64_t)place) - place / 2;
    along.at[a] = (int64_t)vxm_rng_below(rng, (uint64_t)size) - size / 2;
  }
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++) {
      int64_t off = (int64_t)vxm_rng_below(rng, (uint64_t)size) - size / 2;
      if (kind == 0 || kind == 1) /* thin: all but on a line, if not on it */
        off = (int64_t)(along.at[a] * c / 2) + (int64_t)vxm_rng_below(rng, kind == 0 ? 1 : 3);
      else if (kind == 2 && a == (int)(size % 3))
        off = 0;
      else if (kind == 3 && c == 1)
        off = 0;
      corner[c].at[a] = from.at[a] + (kind == 3 && c == 2 ? 0 : off);
    }
}

static void test_triangle(void **state) {
  (void)state;
  vxm_rng rng = {31};
  double worst = 0;
  for (int round = 0; round < ROUNDS(20000); round++) {
    vec corner[3];
    random_triangle(corner, &rng);
    double corners[3][3], longest = 0;
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++) {
        corners[c][a] = (double)corner[c].at[a];
        longest = fmax(longest, fabs((double)(corner[c].at[a] - corner[(c + 1) % 3].at[a])));
      }
    vxm_distance_triangle triangle;
    vxm_distance_triangle_make(&triangle, (const double(*)[3])corners);
    for (int n = 0; n < 10; n++) {
      int64_t range = INT64_C(1) << (1 + vxm_rng_below(&rng, 20));
      vec p;
      double at[3];
      for (int a = 0; a < 3; a++) {
        p.at[a] = corner[n % 3].at[a] + (int64_t)vxm_rng_below(&rng, (uint64_t)range) - range / 2;
        if (n == 9) /* in the plane, and about in the middle */
          p.at[a] = (corner[0].at[a] + corner[1].at[a] + corner[2].at[a]) / 3;
        at[a] = (double)p.at[a];
      }
      long double right = triangle_distance(p, corner);
      long double made = sqrtl((long double)vxm_triangle_distance2(&triangle, at));
      worst = fmax(worst, fabs((double)(made - right)) / ((double)right + longest + 1));
    }
  }
  if (worst > 0x1p-49)
    fail_msg("off by %g of the distance and the longest edge", worst);
}

/* ---- The tree ---- */

static vxm_point_block random_tile(double extent, vxm_rng *rng, int kind) {
  static const double most[] = {INFINITY, 3, INFINITY, 0.4, 20};
  vxm_point_block tile = {.max_distance = most[kind % 5]};
  for (int a = 0; a < 3; a++) {
    tile.step[a] = kind % 4 == 3 ? 0.3 + 0.7 * vxm_rng_unit(rng) : 1;
    tile.first[a] = (int64_t)vxm_rng_below(rng, (uint64_t)extent + 1);
    tile.count[a] = kind % 2 ? 1 + (int)vxm_rng_below(rng, VXM_BVH_TILE) : VXM_BVH_TILE;
  }
  return tile;
}

static void check_tile(const vxm_distance_bvh *tree, const vxm_point_block *tile,
                       const vxm_distance_triangle *triangles, size_t count) {
  static double squares[2][VXM_BVH_TILE_POINTS];
  vxm_distance_bvh_tile_fn *builds[2];
  size_t build_count = vxm_distance_bvh_tile_all(builds);
  bool is_met[2];
  for (size_t b = 0; b < build_count; b++) {
    vxm_search *search;
    assert_int_equal(vxm_search_create(&search, tree, NULL), VXM_OK);
    is_met[b] = builds[b](search, squares[b], tile);
    vxm_search_destroy(search);
  }
  for (int k = 0; k < tile->count[2]; k++)
    for (int j = 0; j < tile->count[1]; j++)
      for (int i = 0; i < tile->count[0]; i++) {
        const int n[3] = {i, j, k};
        double p[3], right = INFINITY, most2 = tile->max_distance * tile->max_distance;
        for (int a = 0; a < 3; a++)
          p[a] = ((double)(tile->first[a] + n[a]) + 0.5) * tile->step[a];
        for (size_t t = 0; t < count; t++)
          right = fmin(right, vxm_triangle_distance2(&triangles[t], p));
        for (size_t b = 0; b < build_count; b++) {
          double made = is_met[b] ? squares[b][(k * VXM_BVH_TILE + j) * VXM_BVH_TILE + i] : INFINITY;
          if (right < most2 ? made != right : made < most2)
            fail_msg("(%d, %d, %d), build %zu: %.17g, not %.17g", i, j, k, b, made, right);
        }
      }
}

static void test_tiles(void **state) {
  (void)state;
  static const size_t counts[] = {1, 2, 7, 9, 64, 65, 130, 600, 1100};
  vxm_rng rng = {32};
  for (int round = 0; round < ROUNDS(90); round++) {
    size_t count = counts[round % 9];
    double extent = round % 4 == 0 ? 100 : 16;
    triangle_corners *corners = malloc(count * sizeof *corners);
    vxm_distance_triangle *triangles = malloc(count * sizeof *triangles);
    fill_corners(corners, count, extent, &rng, round / 9 + round);
    for (size_t t = 0; t < count; t++)
      vxm_distance_triangle_make(&triangles[t], (const double(*)[3])corners[t]);
    vxm_distance_bvh *tree;
    assert_int_equal(vxm_distance_bvh_create(&tree, context, count, corners_of, corners, NULL), VXM_OK);
    for (int n = 0; n < 2; n++) {
      vxm_point_block tile = random_tile(extent, &rng, round + n);
      check_tile(tree, &tile, triangles, count);
    }
    vxm_distance_bvh_destroy(tree);
    free(triangles);
    free(corners);
  }
}

/** Points as far from all of many triangles: nothing can be ruled out. */
static void test_middle_of_a_sphere(void **state) {
  (void)state;
  enum { COUNT = 2000 };
  vxm_rng rng = {33};
  triangle_corners *corners = malloc(COUNT * sizeof *corners);
  vxm_distance_triangle *triangles = malloc(COUNT * sizeof *triangles);
  for (size_t t = 0; t < COUNT; t++) {
    double out[3], length = 0;
    for (int a = 0; a < 3; a++) {
      out[a] = vxm_rng_unit(&rng) - 0.5;
      length += out[a] * out[a];
    }
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        corners[t][c][a] = 8 + 100 * out[a] / sqrt(length) + 0.01 * vxm_rng_unit(&rng);
    vxm_distance_triangle_make(&triangles[t], (const double(*)[3])corners[t]);
  }
  vxm_distance_bvh *tree;
  assert_int_equal(vxm_distance_bvh_create(&tree, context, COUNT, corners_of, corners, NULL), VXM_OK);
  vxm_point_block tile = {{0, 0, 0}, {VXM_BVH_TILE, VXM_BVH_TILE, VXM_BVH_TILE}, {1, 1, 1}, INFINITY};
  check_tile(tree, &tile, triangles, COUNT);
  vxm_distance_bvh_destroy(tree);
  free(triangles);
  free(corners);
}

/** So far away that floats cannot tell which is nearer. */
static void test_far_away(void **state) {
  (void)state;
  enum { COUNT = 300 };
  vxm_rng rng = {35};
  triangle_corners corners[COUNT];
  vxm_distance_triangle triangles[COUNT];
  for (int round = 0; round < 12; round++) {
    double far[3];
    for (int a = 0; a < 3; a++)
      far[a] = (vxm_rng_unit(&rng) - 0.5) * pow(10, 3 + round % 4);
    fill_corners(corners, COUNT, 1e-3, &rng, round);
    for (size_t t = 0; t < COUNT; t++) {
      for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
          corners[t][c][a] += far[a];
      vxm_distance_triangle_make(&triangles[t], (const double(*)[3])corners[t]);
    }
    vxm_distance_bvh *tree;
    assert_int_equal(vxm_distance_bvh_create(&tree, context, COUNT, corners_of, corners, NULL), VXM_OK);
    vxm_point_block tile = {{0, 0, 0}, {VXM_BVH_TILE, VXM_BVH_TILE, VXM_BVH_TILE}, {1, 1, 1}, INFINITY};
    check_tile(tree, &tile, triangles, COUNT);
    vxm_distance_bvh_destroy(tree);
  }
}

/** A limit is kept: estimates hold, and what cannot be made leaves nothing behind. */
static void test_memory(void **state) {
  (void)state;
  enum { COUNT = 5000 };
  vxm_rng rng = {34};
  triangle_corners *corners = malloc(COUNT * sizeof *corners);
  fill_corners(corners, COUNT, 50, &rng, 2);
  for (int part = 0; part <= 10; part++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.memory_limit =
        (vxm_distance_bvh_bytes(COUNT) + vxm_distance_bvh_search_bytes(COUNT)) * (uint64_t)part / 10 + 1;
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_distance_bvh *tree;
    vxm_search *search = NULL;
    vxm_status status = vxm_distance_bvh_create(&tree, own, COUNT, corners_of, corners, NULL);
    if (status == VXM_OK)
      status = vxm_search_create(&search, tree, NULL);
    assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
    assert_true((status == VXM_OK) == (search != NULL));
    assert_true(part < 10 || status == VXM_OK);
    vxm_search_destroy(search);
    vxm_distance_bvh_destroy(tree);
    vxm_context_destroy(own);
  }
  free(corners);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_triangle),
      cmocka_unit_test(test_tiles),
      cmocka_unit_test(test_middle_of_a_sphere),
      cmocka_unit_test(test_far_away),
      cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}
