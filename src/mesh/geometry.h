/* SPDX-License-Identifier: BSD-3-Clause */
/** Areas and volumes of polygons. */
#ifndef VXM_MESH_GEOMETRY_H
#define VXM_MESH_GEOMETRY_H

#include "mesh/soup.h"

#include <math.h>

typedef struct vxm_vec3 {
  double x, y, z;
} vxm_vec3;

static inline vxm_vec3 vxm_vec3_sum(vxm_vec3 a, vxm_vec3 b) {
  return (vxm_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline vxm_vec3 vxm_vec3_cross(vxm_vec3 a, vxm_vec3 b) {
  return (vxm_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vxm_vec3_dot(vxm_vec3 a, vxm_vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline double vxm_vec3_length(vxm_vec3 a) {
  return sqrt(vxm_vec3_dot(a, a));
}

/** (p - q) * scale; with a power of two that brings the mesh to unit size nothing overflows: differences do
 * in a large mesh, and products in a small one far from the origin. */
static inline double vxm_scaled_between(double p, double q, double scale) {
  return scale < 1 ? p * scale - q * scale : (p - q) * scale;
}

static inline vxm_vec3 vxm_vec3_between(const double *p, const double *q, double scale) {
  return (vxm_vec3){vxm_scaled_between(p[0], q[0], scale), vxm_scaled_between(p[1], q[1], scale),
                    vxm_scaled_between(p[2], q[2], scale)};
}

/**
 * Vector area of a polygon (Newell), of positions multiplied by `scale`: its length is the area and its
 * direction the normal of a plane polygon. Taken relative to the first corner, so that a small polygon far
 * from the origin loses nothing. Zero below three corners.
 */
static inline vxm_vec3 vxm_polygon_area(const double *positions, const uint32_t *corners, size_t count,
                                        double scale) {
  vxm_vec3 sum = {0, 0, 0};
  if (count < 3)
    return sum;
  const double *origin = positions + 3 * (size_t)corners[0];
  vxm_vec3 last = vxm_vec3_between(positions + 3 * (size_t)corners[1], origin, scale);
  for (size_t i = 2; i < count; i++) {
    vxm_vec3 next = vxm_vec3_between(positions + 3 * (size_t)corners[i], origin, scale);
    vxm_vec3 cross = vxm_vec3_cross(last, next);
    sum.x += cross.x;
    sum.y += cross.y;
    sum.z += cross.z;
    last = next;
  }
  return (vxm_vec3){0.5 * sum.x, 0.5 * sum.y, 0.5 * sum.z};
}

/**
 * Sum of the areas of the triangles from the first corner, which unlike the vector area is zero only if all
 * corners lie on a line through it.
 */
static inline double vxm_polygon_fan_area(const double *positions, const uint32_t *corners, size_t count,
                                          double scale) {
  double sum = 0;
  if (count < 3)
    return sum;
  const double *origin = positions + 3 * (size_t)corners[0];
  vxm_vec3 last = vxm_vec3_between(positions + 3 * (size_t)corners[1], origin, scale);
  for (size_t i = 2; i < count; i++) {
    vxm_vec3 next = vxm_vec3_between(positions + 3 * (size_t)corners[i], origin, scale);
    sum += vxm_vec3_length(vxm_vec3_cross(last, next));
    last = next;
  }
  return 0.5 * sum;
}

/**
 * Signed volume of the cone from a point to the polygon's triangles about its first corner: positive if the
 * polygon faces away from the point. Over a closed mesh the sum is the enclosed volume.
 *
 * @param corner relative position of the polygon's first corner, as seen from the point
 * @param area   vxm_polygon_area
 */
static inline double vxm_polygon_cone(vxm_vec3 corner, vxm_vec3 area) {
  return vxm_vec3_dot(corner, area) / 3.0;
}

/** Vector area of a face of a soup, as vxm_polygon_area. */
static inline vxm_vec3 vxm_face_area(const vxm_soup *soup, size_t face, double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  return vxm_polygon_area(soup->positions, corner, count, scale);
}

/**
 * The cone from a point to a face of a soup, of positions multiplied by `scale`; nothing without a corner.
 *
 * @param[out] area vxm_polygon_area; may be NULL
 */
static inline double vxm_face_cone(vxm_vec3 *area, const vxm_soup *soup, size_t face, const double from[3],
                                   double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  vxm_vec3 own = vxm_polygon_area(soup->positions, corner, count, scale);
  if (area)
    *area = own;
  return count > 0 ? vxm_polygon_cone(vxm_vec3_between(vxm_position(soup, corner[0]), from, scale), own) : 0;
}

/** A mean of three numbers, which rounding may have put beyond them: never so. A point of a triangle that lay
 * outside the box of its mesh by that would see none of it. */
static inline double vxm_between_three(double mean, double a, double b, double c) {
  return fmin(fmax(mean, fmin(a, fmin(b, c))), fmax(a, fmax(b, c)));
}

/** Whether a point comes before another one in space: by x, then y, then z. */
static inline bool vxm_lies_before(const double *p, const double *q) {
  for (int a = 0; a < 3; a++)
    if (p[a] != q[a])
      return p[a] < q[a];
  return false;
}

#endif
