/* SPDX-License-Identifier: BSD-3-Clause */
/** Oriented triangles as they lie on a lattice, ready to be asked for their winding number in one window
 * after the other. */
#ifndef VXM_VOXEL_WINDING_WINDING_MESH_H
#define VXM_VOXEL_WINDING_WINDING_MESH_H

#include "voxel/winding/brick_mask.h"
#include "voxel/winding/chain_winding.h"
#include "voxel/winding/winding_tree.h"

typedef struct vxm_winding_mesh {
  vxm_context *context;
  const vxm_winding_chain *chain; /**< lent; NULL = not placed */
  const vxm_snapped_points *placed;
  vxm_winding_tree tree;         /**< of the chain's rest */
  vxm_chain_winding closed;      /**< of the window before */
  vxm_brick_mask asked, doubted; /**< of the window before */
} vxm_winding_mesh;

/** A mesh that is not placed yet. */
vxm_winding_mesh vxm_winding_mesh_of(vxm_context *context);
/**
 * Places a chain; it and the points are lent.
 *
 * @param axis     along which the rows of windows will run
 * @param mirrored the points have been placed by a transform that turns triangles inside out
 * @return as vxm_winding_tree_create
 */
vxm_status vxm_winding_mesh_place(vxm_winding_mesh *mesh, const vxm_winding_chain *chain,
                                  const vxm_snapped_points *placed, int axis, bool mirrored,
                                  vxm_error *error);
void vxm_winding_mesh_destroy(vxm_winding_mesh *mesh);

#endif
