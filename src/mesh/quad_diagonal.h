/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Which diagonal cuts a polygon of four corners into two triangles: one that lies inside, as seen along the
 * axis on which the vector area is largest; of two such the shorter one; of two as long that from the corner
 * that is first in space. So it depends neither on the corner that a polygon begins with, nor on the way it
 * is wound, and turning a mesh by right angles or mirroring it turns its diagonals, but for such ties.
 */
#ifndef VXM_MESH_QUAD_DIAGONAL_H
#define VXM_MESH_QUAD_DIAGONAL_H

#include "mesh/geometry.h"
#include "mesh/orient2d.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/** vxm_quad_diagonal, whatever the positions are. */
static inline size_t vxm_quad_diagonal_exact(const double *const at[4]) {
  double most = 0, sum = 0, area[3], first[3], second[3];
  for (int k = 0; k < 4; k++)
    for (int a = 0; a < 3; a++) {
      most = fabs(at[k][a]) > most ? fabs(at[k][a]) : most;
      sum += at[k][a] - at[k][a]; /* 0, or no number */
    }
  double scale = sum == 0 ? vxm_scale_near_one(most) : 0;
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

/** The corner with the diagonal: 0 (as well as 2), or 1 (as well as 3). */
static inline size_t vxm_quad_diagonal(const double *const at[4]) {
  const double bound = 3.3306690738754716e-16; /* see vxm_orient2d */
  const double *p = at[0], *q = at[1], *r = at[2], *s = at[3];
  double length[2] = {vxm_squared_length(r, p, 1), vxm_squared_length(s, q, 1)};
  double first[3], second[3], area[3];
  for (int a = 0; a < 3; a++) {
    first[a] = r[a] - p[a];
    second[a] = s[a] - q[a];
  }
  area[0] = fabs(first[1] * second[2] - first[2] * second[1]);
  area[1] = fabs(first[2] * second[0] - first[0] * second[2]);
  area[2] = fabs(first[0] * second[1] - first[1] * second[0]);
  size_t axis = area[1] > area[0];
  axis = area[2] > area[axis] ? 2 : axis;
  size_t u = axis < 2 ? axis + 1 : 0, v = axis > 0 ? axis - 1 : 2;
  const double low = 0x1p-200, high = 0x1p200; /* no product overflows or vanishes */
  bool sure = (length[0] > low) & (length[0] < high) & (length[1] > low) & (length[1] < high) &
              (length[0] != length[1]) & (area[u] != area[axis]) & (area[v] != area[axis]);
  const double edge[4][2] = {{q[u] - p[u], q[v] - p[v]},
                             {r[u] - q[u], r[v] - q[v]},
                             {s[u] - r[u], s[v] - r[v]},
                             {p[u] - s[u], p[v] - s[v]}};
  double turn[4]; /* behind each edge */
  for (int k = 0; k < 4; k++) {
    double left = edge[k][0] * edge[(k + 1) % 4][1], right = edge[k][1] * edge[(k + 1) % 4][0];
    turn[k] = left - right;
    sure &= fabs(turn[k]) > bound * (fabs(left) + fabs(right)) + 0x1p-900;
  }
  bool inside[2] = {(turn[0] > 0) == (turn[2] > 0), (turn[1] > 0) == (turn[3] > 0)};
  if (!sure)
    return vxm_quad_diagonal_exact(at);
  return inside[0] != inside[1] ? inside[1] : length[1] < length[0];
}

/** The corner at which all triangles of a polygon meet: of four corners an end of the diagonal; 0 of three,
 * and of more, which are measured as a fan. */
static inline size_t vxm_polygon_apex(const double *positions, const uint32_t *corners, size_t count) {
  const double *at[4];
  if (count != 4)
    return 0;
  for (int k = 0; k < 4; k++)
    at[k] = positions + 3 * (size_t)corners[k];
  return vxm_quad_diagonal(at);
}

#endif
