/* SPDX-License-Identifier: BSD-3-Clause */
/** How sure each voxel is. */
#ifndef VXM_VOXEL_CONFIDENCE_H
#define VXM_VOXEL_CONFIDENCE_H

#include "grid/bitgrid.h"

/**
 * Fills a byte per voxel, x fastest, with 255 times the share of the voters that agree with the grid.
 *
 * @param closed  what the closed parts fill; there every voter agrees
 * @param voters  x, y, z and tetra of the other parts; NULL if there are none, then every voxel has 255
 * @param settled voxels that keep the byte they have; may be NULL
 */
void vxm_confidence_fill(uint8_t *confidence, const vxm_grid *grid, const vxm_grid *closed,
                         vxm_grid *const voters[4], const vxm_grid *settled);

#endif
