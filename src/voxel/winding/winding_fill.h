/* SPDX-License-Identifier: BSD-3-Clause */
/** Deciding voxels by their winding number. */
#ifndef VXM_VOXEL_WINDING_WINDING_FILL_H
#define VXM_VOXEL_WINDING_WINDING_FILL_H

#include "grid/window.h"
#include "voxel/winding/winding.h"

/**
 * Sets in a window the voxels whose winding number is above 1/2; others stay as they are.
 *
 * @param asked      words of the voxels to ask about, laid out as the window's; NULL = all
 * @param confidence NULL, or a byte per voxel of the whole grid, x fastest: of those asked about it becomes
 * 255 min(1, |2 w - 1|). The window is then a whole grid
 * @param added      is increased by the voxels newly set
 * @return VXM_OK, VXM_ERROR_CANCELLED
 *
 * Costs only bricks of 4 x 4 x 4 voxels that hold one asked about. The same bits for any number of threads,
 * and however a grid is cut into windows.
 */
vxm_status vxm_winding_fill(const vxm_window *window, const uint64_t *asked, const vxm_winding *winding,
                            vxm_context *context, uint8_t *confidence, int64_t *added, vxm_error *error);

#endif
