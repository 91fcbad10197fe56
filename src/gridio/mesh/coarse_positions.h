/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether the numbers of a file tell the vertices of a surface apart. */
#ifndef VXM_GRIDIO_MESH_COARSE_POSITIONS_H
#define VXM_GRIDIO_MESH_COARSE_POSITIONS_H

#include "grid/bitgrid.h"
#include "mesh/soup.h"

/**
 * Far from the origin the numbers that hold positions are coarser than voxels: what vxm_gridio_surface_mesh
 * made would be faces without area, and edges of more faces than two.
 *
 * @param surface its positions are rounded, where that may matter; those beyond 32-bit floats are left alone,
 *                as writing says
 * @param single  the file has 32-bit floats
 * @return VXM_OK; VXM_ERROR_RANGE where vertices of different places would be at one; VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_check_coarse_positions(vxm_soup *surface, const vxm_space *space, bool single,
                                      const char *path, vxm_error *error);

#endif
