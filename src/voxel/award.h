/* SPDX-License-Identifier: BSD-3-Clause */
/** Giving voxels to labels by the nearest face. */
#ifndef VXM_VOXEL_AWARD_H
#define VXM_VOXEL_AWARD_H

#include "grid/window.h"
#include "voxel/forest.h"

/** Which voxels are given. */
typedef struct vxm_award {
  const vxm_forest *forest;
  const vxm_space *space;
  const vxm_window *asked; /**< the voxels in question, of a box of the space */
  int64_t first[3];        /**< voxel of the space at which the box begins, in the order of the layout */
  uint16_t *values;        /**< of the whole space, in the layout of the window */
  uint32_t label;          /**< takes a voxel where it is nearer than the label there; 0 = the nearest of all
                                labels takes it, whatever is there */
} vxm_award;

/**
 * Gives each voxel that is asked about its label. Blocks of voxels are settled at once where the distances of
 * the labels at their middle differ by more than the blocks are wide, so that work follows the boundaries
 * between labels.
 *
 * @return VXM_OK, VXM_ERROR_CANCELLED
 */
vxm_status vxm_award_voxels(const vxm_award *award, vxm_context *context, vxm_error *error);

#endif
