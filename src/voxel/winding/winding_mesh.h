/* SPDX-License-Identifier: BSD-3-Clause */
/** The oriented triangles of some parts on a lattice, and the tree of their winding numbers. */
#ifndef VXM_VOXEL_WINDING_WINDING_MESH_H
#define VXM_VOXEL_WINDING_WINDING_MESH_H

#include "voxel/winding/orient_patches.h"
#include "voxel/winding/winding.h"

typedef struct vxm_winding_mesh {
  vxm_context *context;
  vxm_winding_triangle *triangles;
  vxm_winding *tree; /**< NULL = not made */
} vxm_winding_mesh;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_winding_mesh_create(vxm_winding_mesh *out, const vxm_triangle_set *triangles,
                                   const vxm_snapped_points *placed, const vxm_flip_mask *turns,
                                   bool mirrored, vxm_error *error);
void vxm_winding_mesh_destroy(vxm_winding_mesh *wound);

#endif
