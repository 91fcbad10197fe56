/* SPDX-License-Identifier: BSD-3-Clause */
/** The conservative surface: every voxel whose closed box meets a face, exactly. */
#ifndef VXM_VOXEL_SURFACE_H
#define VXM_VOXEL_SURFACE_H

#include "mesh/soup.h"
#include "voxel/lattice.h"

/**
 * Sets in `grid` every voxel whose closed box meets a face of the soup, no more and no less, by the plane
 * test and the projected edge tests of Schwarz & Seidel 2010, section 3.1, in integers. A face on the border
 * of two voxels sets both. Polygons are cut into triangles inside them first.
 *
 * @param confidence NULL, or a byte per voxel, x fastest: 255 where the surface sets a voxel
 * @return VXM_OK; VXM_ERROR_RANGE as vxm_lattice_snap; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
vxm_status vxm_surface_unite(vxm_grid *grid, const vxm_soup *soup, const vxm_lattice *lattice,
                             uint8_t *confidence, vxm_error *error);

#endif
