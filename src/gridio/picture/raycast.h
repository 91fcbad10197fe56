/* SPDX-License-Identifier: BSD-3-Clause */
/** Rays through a grid, in voxel coordinates: voxel (i,j,k) is the box from (i,j,k) to (i+1,j+1,k+1). */
#ifndef VXM_GRIDIO_PICTURE_RAYCAST_H
#define VXM_GRIDIO_PICTURE_RAYCAST_H

#include "gridio/picture/occupancy_mips.h"

typedef struct vxm_hit {
  double t;         /**< the point is origin + t * direction */
  int64_t voxel[3]; /**< set */
  int axis;         /**< of the face; -1 if the ray begins in the voxel */
  bool positive;    /**< the face looks in the positive direction of the axis */
} vxm_hit;

/** Finds the first set voxel along a ray for t >= 0. The direction is not null and need not have length 1. */
bool vxm_raycast(vxm_hit *hit, const vxm_occupancy_mips *mips, const double origin[3],
                 const double direction[3]);

#endif
