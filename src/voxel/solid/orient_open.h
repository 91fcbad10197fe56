/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The parts that stay open, turned outward. It is found out once, from a grid of fixed resolution
 * along the longest side of the mesh, so that it is the same whatever grid is made of the mesh.
 */
#ifndef VXM_VOXEL_SOLID_ORIENT_OPEN_H
#define VXM_VOXEL_SOLID_ORIENT_OPEN_H

#include "voxel/solid/voxel_pass.h"

/** Bytes that turning a triangle, making its chain and then using that takes at most: neighbours, sides,
 * tree. */
#define VXM_TURNED_BYTES UINT64_C(400)
/** Bytes of the grids that are looked at: five of 260 voxels along an axis, and scratch. */
#define VXM_ORIENT_BYTES (UINT64_C(20) << 20)

/** A pass over a grid of fixed resolution, and that grid. */
typedef struct vxm_orient_pass {
  vxm_voxel_pass pass;
  vxm_window window;
} vxm_orient_pass;

/**
 * Begins such a pass: the solid by votes, on the CPU. Destroy `pass` with vxm_voxel_pass_destroy, also after
 * a failure.
 *
 * @param workspace lent until then
 */
vxm_status vxm_orient_pass_begin(vxm_orient_pass *out, const vxm_mesh_analysis *analysis,
                                 vxm_workspace *workspace, vxm_error *error);

/**
 * The chain of the parts that stay open.
 *
 * @param workspace lent for as long as the call takes
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_orient_open(const vxm_winding_chain **out, const vxm_mesh_analysis *analysis,
                           vxm_workspace *workspace, vxm_error *error);

#endif
