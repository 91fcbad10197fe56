/* SPDX-License-Identifier: BSD-3-Clause */
/** The chain of a mesh's faces, each turned outward. */
#ifndef VXM_VOXEL_WINDING_ORIENTED_CHAIN_H
#define VXM_VOXEL_WINDING_ORIENTED_CHAIN_H

#include "voxel/winding/chain.h"
#include "voxel/winding/orient_patches.h"

/** Makes the chain of the triangles that a mask says how to turn. @return as vxm_winding_chain_create */
vxm_status vxm_oriented_chain_create(vxm_winding_chain *out, const vxm_triangle_set *triangles,
                                     const vxm_facings *facings, vxm_error *error);

#endif
