/* SPDX-License-Identifier: BSD-3-Clause */
/** The exact distance from points to a triangle. */
#ifndef VXM_VOXEL_TRIANGLE_H
#define VXM_VOXEL_TRIANGLE_H

#include <stdbool.h>
#include <stdint.h>

/** A triangle made ready: lengths are those of its corners, of which a voxel should be about 1. */
typedef struct vxm_triangle {
  double corner[3][3];
  double edge[3][3]; /**< from corner i to the next */
  double inverse[3]; /**< 1 over the squared length of edge i; 0 for a point */
  double side[3][3]; /**< unit, in the plane, outward from edge i */
  double normal[3];  /**< unit */
  bool has_inside;   /**< false where it is so thin that its edges are all of it */
} vxm_triangle;

void vxm_triangle_make(vxm_triangle *out, const double corner[3][3]);

/** The squared distance of a point. */
double vxm_triangle_distance2(const vxm_triangle *triangle, const double p[3]);

/**
 * Lowers the squared distances of `count` points in a row along the first axis to those of the triangle.
 *
 * @param first the first point
 * @param step  from one to the next
 */
typedef void vxm_triangle_row_fn(const vxm_triangle *triangle, const double first[3], double step,
                                 float *distances2, int64_t count);

/** The build for this processor. */
vxm_triangle_row_fn *vxm_triangle_row_best(void);

#endif
