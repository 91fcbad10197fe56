/* SPDX-License-Identifier: BSD-3-Clause */
/** A box of an octree's voxels as a grid. */
#ifndef VXM_GRID_OCTREE_CROP_H
#define VXM_GRID_OCTREE_CROP_H

#include "grid/octree.h"

/** See vxm_sparse_window in voxmend.h; the box has been checked. */
vxm_status vxm_octree_crop(vxm_grid **out, const vxm_sparse *sparse, const int64_t begin[3],
                           const int64_t end[3], vxm_error *error);

#endif
