/* SPDX-License-Identifier: BSD-3-Clause */
/** Tubes along closed curves that cross themselves, and others that do not. */
#ifndef TEST_VOXEL_TUBES_H
#define TEST_VOXEL_TUBES_H

#include "shapes.h"

#include <math.h>

enum { WIDTH = 20 /**< of a cube in which all of them lie */, RINGS = 36, SIDES = 9 };

typedef struct turning {
  double m[3][3];
} turning;

/** A rotation, by a random quaternion. */
static inline turning random_turning(vxm_rng *rng) {
  double q[4], length = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = vxm_rng_unit(rng) - 0.5;
    length += q[i] * q[i];
  }
  for (int i = 0; i < 4; i++)
    q[i] /= sqrt(length);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  return (turning){{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                    {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                    {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

/** A point of a lattice that voxels have without rounding, so that the oracle sees the same mesh. */
static inline uint32_t lattice_vertex(vxm_soup *soup, const turning *turned, const double p[3]) {
  double at[3];
  for (int a = 0; a < 3; a++) {
    double x = turned->m[a][0] * p[0] + turned->m[a][1] * p[1] + turned->m[a][2] * p[2];
    at[a] = (2 * floor((WIDTH / 2.0 + x) * 64) + 1) / 128;
  }
  return shape_vertex(soup, at[0], at[1], at[2]);
}

/** A tube along a figure of eight whose branches are `apart` where they cross; as wide as `radius`. */
static inline void add_tube(vxm_soup *soup, const turning *turned, double apart, double radius) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t r = 0; r < RINGS; r++) {
    double t = 6.283185307179586 * (r + 0.3) / RINGS;
    double centre[3] = {7 * sin(t), 3.5 * sin(2 * t), apart / 2 * cos(t)};
    double along[3] = {7 * cos(t), 7 * cos(2 * t), -apart / 2 * sin(t)};
    double flat = hypot(along[0], along[1]), all = hypot(flat, along[2]);
    double u[3] = {-along[1] / flat, along[0] / flat, 0};
    double v[3] = {-u[1] * along[2] / all, u[0] * along[2] / all, (u[1] * along[0] - u[0] * along[1]) / all};
    for (uint32_t s = 0; s < SIDES; s++) {
      double b = 6.283185307179586 * s / SIDES, p[3];
      for (int a = 0; a < 3; a++)
        p[a] = centre[a] + radius * (cos(b) * u[a] + sin(b) * v[a]);
      lattice_vertex(soup, turned, p);
    }
  }
  for (uint32_t r = 0; r < RINGS; r++)
    for (uint32_t s = 0; s < SIDES; s++) {
      uint32_t r1 = (r + 1) % RINGS, s1 = (s + 1) % SIDES;
      uint32_t c[4] = {first + r * SIDES + s, first + r1 * SIDES + s, first + r1 * SIDES + s1,
                       first + r * SIDES + s1};
      shape_triangle(soup, c[0], c[2], c[1]);
      shape_triangle(soup, c[0], c[3], c[2]);
    }
}

static inline void reverse_face(vxm_soup *soup, size_t face) {
  uint32_t *corner = soup->indices + soup->offsets[face], swap = corner[1];
  corner[1] = corner[2];
  corner[2] = swap;
}

#endif
