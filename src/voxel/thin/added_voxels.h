/* SPDX-License-Identifier: BSD-3-Clause */
/** The voxels that are added to a solid, chosen from what has been met. */
#ifndef VXM_VOXEL_THIN_ADDED_VOXELS_H
#define VXM_VOXEL_THIN_ADDED_VOXELS_H

#include "voxel/thin/meeting_slabs.h"
#include "voxel/thin/voxel_set.h"

/** Where voxels go: into the words of a view, or into a set beside its octree. */
typedef struct vxm_added_voxels {
  vxm_voxel_set *set;  /**< NULL = the words */
  uint8_t *confidence; /**< NULL = not asked for; see vxm_thin_add */
} vxm_added_voxels;

/**
 * Sets the voxels that meetings ask for, stage by stage: each link, square or cube chooses by what is set
 * before its stage. So the order within a stage does not matter, and what is added depends on what is near
 * only.
 *
 * @param slabs are used up
 * @param[in,out] added voxels of slices that are counted
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_add_voxels(const vxm_added_voxels *to, const vxm_thin_job *job, vxm_meeting_slabs *slabs,
                          int64_t *added, vxm_error *error);

#endif
