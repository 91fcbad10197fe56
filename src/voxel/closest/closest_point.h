/* SPDX-License-Identifier: BSD-3-Clause */
/** The point of a triangle that is the nearest to another point. */
#ifndef VXM_VOXEL_CLOSEST_CLOSEST_POINT_H
#define VXM_VOXEL_CLOSEST_CLOSEST_POINT_H

#include <stdbool.h>

typedef struct vxm_closest_triangle {
  double at[3][3];
  bool is_thin; /**< its edges are all of it */
} vxm_closest_triangle;

void vxm_closest_triangle_make(vxm_closest_triangle *out, const double at[3][3]);

/** The foot of a point, and its squared distance from there. */
double vxm_closest_point(const vxm_closest_triangle *corners, const double p[3], double foot[3]);

#endif
