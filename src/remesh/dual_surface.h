/* SPDX-License-Identifier: BSD-3-Clause */
/** The surface between voxel centres that are set and those that are not, as a mesh. */
#ifndef VXM_REMESH_DUAL_SURFACE_H
#define VXM_REMESH_DUAL_SURFACE_H

#include "grid/bitgrid.h"
#include "mesh/soup.h"

/**
 * A surface in the making. Slice after slice is put in: bits, and for each link between a set centre and one
 * that is not the share of it at which the surface crosses it. Cells of eight centres have a vertex for each
 * sheet that passes through them, in the middle of the links it crosses; each crossed link has two triangles
 * between the vertices of the four cells around it ("surface nets", Gibson 1998, with the sheets of Nielson
 * 2004). The outermost voxels count as empty. So the surface is closed and turned outward.
 */
typedef struct vxm_dual_surface vxm_dual_surface;

/** @param space of the voxels @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_dual_surface_create(vxm_dual_surface **out, vxm_context *context, const vxm_space *space,
                                   vxm_error *error);
/** NULL is allowed. */
void vxm_dual_surface_destroy(vxm_dual_surface *surface);

/**
 * Puts in the next slice along z.
 *
 * @param bits   rows as of a vxm_grid
 * @param shares of the links that begin at each centre, along x, y and z; those that are not crossed are not
 *               read
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_dual_surface_put(vxm_dual_surface *surface, const uint64_t *bits, const float (*shares)[3],
                                vxm_error *error);

/**
 * Takes what was made, which is the caller's then.
 *
 * @param[out] meets_itself some cell has a sheet that may have an edge in common with itself, so that four
 *                          triangles share it
 */
vxm_soup *vxm_dual_surface_take(vxm_dual_surface *surface, bool *meets_itself);

#endif
