/* SPDX-License-Identifier: BSD-3-Clause */
/** The point of a triangle that is the nearest to another point. */
#ifndef VXM_VOXEL_FOOT_H
#define VXM_VOXEL_FOOT_H

#include <stdbool.h>

typedef struct vxm_corners {
  double at[3][3];
  bool is_thin; /**< its edges are all of it */
} vxm_corners;

void vxm_corners_make(vxm_corners *out, const double at[3][3]);

/** The foot of a point, and its squared distance from there. */
double vxm_corners_foot(const vxm_corners *corners, const double p[3], double foot[3]);

#endif
