/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles of a closed chain by the side that they show to the rows of a grid. */
#ifndef VXM_VOXEL_WINDING_CHAIN_SIDES_H
#define VXM_VOXEL_WINDING_CHAIN_SIDES_H

#include "voxel/parity/snapped_points.h"
#include "voxel/winding/chain.h"

/** Triangles that rows enter from the beginning of a list on, those that they leave at its end. */
typedef struct vxm_chain_sides {
  uint32_t (*corners)[3];
  size_t entered; /**< so many */
  size_t left;    /**< these begin there */
  double rows;    /**< crossings of all of them, at most */
} vxm_chain_sides;

/**
 * Sorts those that rows may cross.
 *
 * @param corners  room for all of the chain
 * @param axis     along which rows run
 * @param mirrored the points have been placed by a transform that turns triangles inside out
 */
vxm_chain_sides vxm_chain_sides_sort(uint32_t (*corners)[3], const vxm_winding_chain *chain,
                                     const vxm_snapped_points *placed, int axis, bool mirrored);

#endif
