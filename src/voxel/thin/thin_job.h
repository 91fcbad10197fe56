/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid and the surface that is to be held together. */
#ifndef VXM_VOXEL_THIN_THIN_JOB_H
#define VXM_VOXEL_THIN_THIN_JOB_H

#include "voxel/parity/snapped_points.h"
#include "voxel/thin/dual_elements.h"

/** Bits of the short number of a cell along one axis; the highest is not used. */
enum { VXM_SHORT_BITS = 10 };

/** Maps of the voxels in the middle of boxes. */
enum { VXM_MIDDLES = 4 };

/** What all threads look at. */
typedef struct vxm_thin_job {
  const vxm_triangle_set *triangles;
  const uint32_t (*corners)[3]; /**< of them */
  const vxm_snapped_points *placed;
  const uint32_t *order; /**< NULL, or the triangles that are looked at, for vxm_sieve_of alone */
  size_t order_count;
  vxm_view view;               /**< the solid; nothing is set while threads look */
  int64_t counted[2];          /**< slices that samples are counted in */
  int slow;                    /**< the axis of slices */
  const uint32_t *short_cells; /**< NULL, or the cells of points, along the fast axis from bit 0 on, the
                                  middle one from VXM_SHORT_BITS, the slow one from twice that */
  const uint64_t *middles; /**< NULL, or with them VXM_MIDDLES bit maps like the view's words, side by side:
                              by the axes along which a box of cells has two (1: the middle axis, 2: the slow
                              one), whether a voxel in the middle of the box is set; a bit is that of the
                              voxel behind the first cell */
  int directions; /**< VXM_LINK_AXES, or VXM_LINK_DIRECTIONS for links over edges and corners of voxels, too
                   */
} vxm_thin_job;

#endif
