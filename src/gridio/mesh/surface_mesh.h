/* SPDX-License-Identifier: BSD-3-Clause */
/** The surface of a grid as a mesh. */
#ifndef VXM_GRIDIO_MESH_SURFACE_MESH_H
#define VXM_GRIDIO_MESH_SURFACE_MESH_H

#include "grid/bitgrid.h"
#include "mesh/soup.h"

/** What is made of it; together or 0. */
enum vxm_surface_mesh_flags {
  VXM_SURFACE_MESH_MANIFOLD =
      1, /**< voxels that touch in an edge or a corner alone have vertices of their own there,
            moved by VXM_SPLIT_SHARE: every edge has two faces, every vertex one fan */
  VXM_SURFACE_MESH_TRIANGLES =
      2 /**< the rectangles as triangles, none of which lies on the border of a rectangle */
};

/**
 * Makes a mesh of the exposed voxel faces, merged into rectangles that share vertices. It is closed mod 2:
 * every edge has an even number of faces.
 *
 * @param flags of vxm_surface_mesh_flags
 * @return VXM_OK; VXM_ERROR_RANGE for more than 2^30 rectangles; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_gridio_surface_mesh(vxm_soup **out, const vxm_grid *grid, unsigned flags, vxm_error *error);

#endif
