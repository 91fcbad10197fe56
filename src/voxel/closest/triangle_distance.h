/* SPDX-License-Identifier: BSD-3-Clause */
/** The exact distance from a point to a triangle, in a frame of the triangle's own. */
#ifndef VXM_VOXEL_CLOSEST_TRIANGLE_DISTANCE_H
#define VXM_VOXEL_CLOSEST_TRIANGLE_DISTANCE_H

/**
 * A triangle in a frame whose first axis runs along its longest edge, from (0, 0) to (length, 0), the second
 * across it to the apex, the third along the normal. Frames of slivers may be turned about the longest edge
 * by more than rounding, which moves no point of the triangle by more than rounding: so the distance of a
 * point is off by some 1e-15 times its distance and the longest edge, whatever the shape.
 */
typedef struct vxm_distance_triangle {
  double base[3];
  double axis[3][3]; /**< unit */
  double length;
  double apex[2];   /**< along and across */
  double leg[2][2]; /**< unit: from the end of the longest edge, and from its beginning, to the apex */
  double leg_length[2];
} vxm_distance_triangle;

/** A height of this part of the longest edge is rounding. */
#define VXM_DISTANCE_FLAT 1e-15

void vxm_distance_triangle_make(vxm_distance_triangle *out, const double corner[3][3]);

/** The squared distance of a point. */
double vxm_triangle_distance2(const vxm_distance_triangle *triangle, const double p[3]);

#endif
