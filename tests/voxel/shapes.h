/* SPDX-License-Identifier: BSD-3-Clause */
/** Small soups for the tests of voxelization. */
#ifndef TEST_VOXEL_SHAPES_H
#define TEST_VOXEL_SHAPES_H

#include "base/rng.h"
#include "mesh/soup.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

/** The context of a test program, made and dropped around its tests. */
static vxm_context *context;

static inline int setup(void **state) {
  (void)state;
  return vxm_context_create(&context, NULL, NULL) != VXM_OK;
}

static inline int teardown(void **state) {
  (void)state;
  vxm_context_destroy(context);
  return 0;
}

static inline vxm_soup *shape_empty(vxm_context *owner) {
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, owner, "test", NULL), VXM_OK);
  return soup;
}

static inline uint32_t shape_vertex(vxm_soup *soup, double x, double y, double z) {
  assert_int_equal(vxm_soup_add_vertex(soup, x, y, z, NULL), VXM_OK);
  return (uint32_t)(soup->vertex_count - 1);
}

static inline void shape_face(vxm_soup *soup, const uint32_t *corner, size_t n) {
  assert_int_equal(vxm_soup_add_face(soup, corner, n, NULL), VXM_OK);
}

static inline void shape_triangle(vxm_soup *soup, uint32_t a, uint32_t b, uint32_t c) {
  shape_face(soup, (uint32_t[]){a, b, c}, 3);
}

/** An axis-aligned box of six quads. */
static inline void shape_box(vxm_soup *soup, const double low[3], const double high[3]) {
  uint32_t v[8];
  for (int i = 0; i < 8; i++)
    v[i] = shape_vertex(soup, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
  static const int quad[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int f = 0; f < 6; f++)
    shape_face(soup, (uint32_t[]){v[quad[f][0]], v[quad[f][1]], v[quad[f][2]], v[quad[f][3]]}, 4);
}

/** A coordinate in whole quarters, `low` to `high` quarters. */
static inline double shape_quarter(vxm_rng *rng, int low, int high) {
  return ((double)low + (double)vxm_rng_below(rng, (uint64_t)(high - low + 1))) / 4;
}

/** An octahedron's faces on six random corners: closed, mostly self-intersecting. */
static inline void shape_random_octahedron(vxm_soup *soup, vxm_rng *rng, int low, int high) {
  uint32_t v[6];
  for (int i = 0; i < 6; i++) {
    double x = shape_quarter(rng, low, high), y = shape_quarter(rng, low, high);
    v[i] = shape_vertex(soup, x, y, shape_quarter(rng, low, high));
  }
  for (uint32_t side = 0; side < 2; side++)
    for (uint32_t i = 0; i < 4; i++)
      shape_triangle(soup, v[4 + side], v[i], v[(i + 1) % 4]);
}

/** A torus of `rings` x `sides` quads; smooth and closed. */
static inline void shape_torus(vxm_soup *soup, uint32_t rings, uint32_t sides, double radius, double tube,
                               const double centre[3]) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t r = 0; r < rings; r++)
    for (uint32_t s = 0; s < sides; s++) {
      double a = 6.283185307179586 * r / rings, b = 6.283185307179586 * s / sides;
      double across = radius + tube * __builtin_cos(b);
      shape_vertex(soup, centre[0] + across * __builtin_cos(a), centre[1] + across * __builtin_sin(a),
                   centre[2] + tube * __builtin_sin(b));
    }
  for (uint32_t r = 0; r < rings; r++)
    for (uint32_t s = 0; s < sides; s++) {
      uint32_t r1 = (r + 1) % rings, s1 = (s + 1) % sides;
      uint32_t corner[4] = {first + r * sides + s, first + r1 * sides + s, first + r1 * sides + s1,
                            first + r * sides + s1};
      shape_face(soup, corner, 4);
    }
}

/** Every second face is left out. */
static inline vxm_soup *shape_sieve(const vxm_soup *whole) {
  vxm_soup *out = shape_empty(whole->context);
  for (size_t v = 0; v < whole->vertex_count; v++)
    shape_vertex(out, whole->positions[3 * v], whole->positions[3 * v + 1], whole->positions[3 * v + 2]);
  for (size_t f = 0; f < whole->face_count; f += 2) {
    size_t n;
    const uint32_t *corner = vxm_face(whole, f, &n);
    shape_face(out, corner, n);
  }
  return out;
}

#endif
