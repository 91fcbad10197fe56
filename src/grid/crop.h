/* SPDX-License-Identifier: BSD-3-Clause */
/** A box of a grid's voxels as a grid of its own. */
#ifndef VXM_GRID_CROP_H
#define VXM_GRID_CROP_H

#include "grid/bitgrid.h"

/** Checks that a box of voxels begin..end-1 is not empty and lies within the dimensions. */
vxm_status vxm_space_check_box(const vxm_space *space, const int64_t begin[3], const int64_t end[3],
                               vxm_error *error);
/** Where the voxels of a checked box lie. */
vxm_space vxm_space_of_box(const vxm_space *space, const int64_t begin[3], const int64_t end[3]);

/** See vxm_grid_window in voxmend.h; the box has been checked. */
vxm_status vxm_grid_crop(vxm_grid **out, const vxm_grid *grid, const int64_t begin[3], const int64_t end[3],
                         vxm_error *error);

#endif
