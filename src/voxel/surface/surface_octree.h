/* SPDX-License-Identifier: BSD-3-Clause */
/** The surface of a mesh as an octree, straight from its triangles. */
#ifndef VXM_VOXEL_SURFACE_SURFACE_OCTREE_H
#define VXM_VOXEL_SURFACE_SURFACE_OCTREE_H

#include "grid/octree_build.h"
#include "voxel/surface/surface.h"

/**
 * Makes the octree of the voxels that vxm_surface_add sets in all of the lattice's space. Memory follows the
 * surface: only strips of nodes, and of these only words, that a triangle may touch are looked at.
 *
 * @param kind conservative or thin
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_surface_octree(vxm_sparse **out, const vxm_surface *surface, vxm_surface_kind kind,
                              vxm_error *error);

#endif
