/* SPDX-License-Identifier: BSD-3-Clause */
/** How much of a surface lies outside of a grid. */
#ifndef VXM_VOXEL_SOLID_OVERHANG_H
#define VXM_VOXEL_SOLID_OVERHANG_H

#include "voxel/parts/triangle_set.h"

typedef struct vxm_overhang {
  double share;            /**< of the area of all faces: 0 to 1 */
  bool below[3], above[3]; /**< the sides beyond which faces lie, along each axis */
} vxm_overhang;

/**
 * Looks for faces outside of a grid, by more than a small part of a voxel, so that what is fitted or lies at
 * a side of the grid is not meant.
 *
 * @param transform NULL, or a 3 x 4 matrix applied to positions first
 */
vxm_overhang vxm_overhang_of(const vxm_triangle_set *triangles, const vxm_space *space,
                             const double transform[12]);

#endif
