/* SPDX-License-Identifier: BSD-3-Clause */
/** An octree with thin parts kept. */
#ifndef VXM_VOXEL_THIN_THIN_SPARSE_H
#define VXM_VOXEL_THIN_THIN_SPARSE_H

#include "grid/octree.h"
#include "voxel/thin/thin.h"

/**
 * Replaces an octree by one with the voxels, too, that hold thin parts together: the same as vxm_thin_add.
 *
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED, then it is as before
 */
vxm_status vxm_thin_add_sparse(vxm_thin_adder *thin, vxm_sparse **octree, const vxm_triangle_set *triangles,
                               const vxm_snapped_points *placed, int separating, vxm_error *error);

#endif
