/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Which diagonal cuts a polygon of four corners into two triangles: one that lies inside, as seen along the
 * axis on which the vector area is largest; of two such the shorter one; of two as long that from the corner
 * that is first in space. So it depends neither on the corner that a polygon begins with, nor on the way it
 * is wound, and turning a mesh by right angles or mirroring it turns its diagonals, but for such ties.
 */
#ifndef VXM_MESH_QUAD_DIAGONAL_H
#define VXM_MESH_QUAD_DIAGONAL_H

#include "mesh/orient2d.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/** Whether a point comes before another one in space: by x, then y, then z. */
static inline bool vxm_lies_before(const double *p, const double *q) {
  for (int a = 0; a < 3; a++)
    if (p[a] != q[a])
      return p[a] < q[a];
  return false;
}

/** A power of two that brings coordinates near 1 if the largest of them needs it, so that products neither
 * overflow nor vanish; 0 if that is not finite. */
static inline double vxm_scale_near_one(double most) {
  if ((most < 0x1p100 && most > 0x1p-100) || most == 0)
    return 1;
  if (!isfinite(most))
    return 0;
  int exponent = -ilogb(most);
  return ldexp(1, exponent < 1023 ? exponent : 1023);
}

/** The squared distance of two points; the same bits whichever axis is which. */
static inline double vxm_squared_length(const double *p, const double *q, double scale) {
  double x = p[0] * scale - q[0] * scale, y = p[1] * scale - q[1] * scale, z = p[2] * scale - q[2] * scale;
  x *= x;
  y *= y;
  z *= z;
  double low = x < y ? x : y, high = x < y ? y : x; /* the largest is added last */
  return z < high ? (low + z) + high : (low + high) + z;
}

/** How far the diagonals lie inside, from corner 0 and from corner 1, as seen along an axis: 1 if the two
 * triangles lie side by side, -1 if they lie over each other, 0 if one has no area. */
static inline void vxm_quad_sides(int inside[2], const double *const at[4], size_t axis, double scale) {
  size_t u = axis < 2 ? axis + 1 : 0, v = axis > 0 ? axis - 1 : 2;
  double plane[4][2];
  for (int k = 0; k < 4; k++) {
    plane[k][0] = at[k][u] * scale;
    plane[k][1] = at[k][v] * scale;
  }
  inside[0] = vxm_orient2d(plane[0], plane[1], plane[2]) * vxm_orient2d(plane[2], plane[3], plane[0]);
  inside[1] = vxm_orient2d(plane[3], plane[0], plane[1]) * vxm_orient2d(plane[1], plane[2], plane[3]);
}

/** The corner with the diagonal: 0 (as well as 2), or 1 (as well as 3). */
static inline size_t vxm_quad_diagonal(const double *const at[4]) {
  double most = 0, area[3], first[3], second[3];
  for (int k = 0; k < 4; k++)
    for (int a = 0; a < 3; a++)
      most = fabs(at[k][a]) <= most ? most : fabs(at[k][a]); /* or no number */
  double scale = vxm_scale_near_one(most);
  for (int a = 0; a < 3; a++) {
    first[a] = at[2][a] * scale - at[0][a] * scale;
    second[a] = at[3][a] * scale - at[1][a] * scale;
  }
  for (int a = 0; a < 3; a++) {
    int u = (a + 1) % 3, v = (a + 2) % 3;
    area[a] = fabs(first[u] * second[v] - first[v] * second[u]);
  }
  double largest = area[0] > area[1] ? area[0] : area[1];
  largest = area[2] > largest ? area[2] : largest;
  int inside[2] = {1, 1};
  for (size_t a = 0; a < 3 && scale > 0; a++)
    if (area[a] == largest) { /* more than one of them as if seen along each */
      int seen[2];
      vxm_quad_sides(seen, at, a, scale);
      for (int d = 0; d < 2; d++)
        inside[d] = seen[d] < inside[d] ? seen[d] : inside[d];
    }
  if (inside[0] != inside[1])
    return inside[1] > inside[0];
  double length[2];
  for (int d = 0; d < 2; d++)
    length[d] = vxm_squared_length(at[d], at[d + 2], scale);
  if (scale > 0 && length[0] != length[1])
    return length[1] < length[0];
  size_t before = 0;
  for (size_t k = 1; k < 4; k++)
    before = vxm_lies_before(at[k], at[before]) ? k : before;
  return before % 2;
}

#endif
