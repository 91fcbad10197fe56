/* SPDX-License-Identifier: BSD-3-Clause */
/** Deciding voxels by their winding number. */
#ifndef VXM_VOXEL_SETTLE_H
#define VXM_VOXEL_SETTLE_H

#include "grid/bitgrid.h"
#include "voxel/winding.h"

/**
 * Sets in `out` the voxels whose winding number is above 1/2; others stay as they are.
 *
 * @param asked      the voxels to ask about; NULL = all
 * @param confidence NULL, or a byte per voxel, x fastest: of those asked about it becomes 255 min(1, |2 w -
 * 1|)
 * @return VXM_OK, VXM_ERROR_CANCELLED
 *
 * Costs only bricks of 4 x 4 x 4 voxels that hold one asked about. The same bits for any number of threads.
 */
vxm_status vxm_settle(vxm_grid *out, const vxm_grid *asked, const vxm_winding *winding, uint8_t *confidence,
                      vxm_error *error);

#endif
