/* SPDX-License-Identifier: BSD-3-Clause */
/** Parts that set no voxel because they are not where the grid is. */
#ifndef VXM_VOXEL_SOLID_OUTSIDE_PARTS_H
#define VXM_VOXEL_SOLID_OUTSIDE_PARTS_H

#include "voxel/solid/voxel_pass.h"

/**
 * Whether a part of a placed pass lies outside of the grid, or reaches so little into it that no layer of
 * voxel centres can meet it, while more than that is outside. A sheet at the side of the grid is not meant.
 */
bool vxm_part_is_outside(const vxm_voxel_pass *pass, size_t part);

#endif
