/* SPDX-License-Identifier: BSD-3-Clause */
/** Giving voxels to labels by the nearest face. */
#ifndef VXM_VOXEL_LABELS_NEAREST_LABEL_H
#define VXM_VOXEL_LABELS_NEAREST_LABEL_H

#include "grid/window.h"
#include "voxel/labels/label_bvh.h"

/** Which voxels are given. */
typedef struct vxm_nearest_label {
  const vxm_label_bvh *bvh;
  const vxm_space *space;
  const vxm_window *asked; /**< all slices of a box of the space: the voxels in question */
  const int64_t *first;    /**< voxel of the space at which the box begins, in the order of the layout */
  uint16_t *values;        /**< of the box, in the layout of the window */
  size_t row, plane;       /**< values from one row, or slice, to the next */
  uint32_t label;          /**< takes a voxel where it is nearer than the label there; 0 = the nearest of all
                                labels takes it, whatever is there */
  const uint8_t *open;     /**< with label 0: NULL, or a flag for each label. Then the nearest of all takes a
                                voxel only if it has the flag, is nearer than the label there, and no farther
                                than the longest side of a voxel */
} vxm_nearest_label;

/**
 * Gives voxels begin..end-1 of the box, in the order of the layout, their labels, as far as they are asked
 * about. Blocks of voxels are settled at once where the distances of labels at their middle differ by more
 * than the blocks are wide, so that work follows the boundaries between labels.
 *
 * @param begin the first a multiple of 16
 */
void vxm_nearest_label_voxels(const vxm_nearest_label *nearest, const int64_t begin[3], const int64_t end[3]);

/** Whether a face may be no farther than the longest side of a voxel from some of the voxels of a cube. */
bool vxm_nearest_label_may_reach(const vxm_label_bvh *bvh, const vxm_space *space, const int64_t at[3],
                                 int64_t side);

#endif
