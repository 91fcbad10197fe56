/* SPDX-License-Identifier: BSD-3-Clause */
/** Deciding voxels by their winding number. */
#ifndef VXM_VOXEL_WINDING_WINDING_FILL_H
#define VXM_VOXEL_WINDING_WINDING_FILL_H

#include "voxel/winding/winding_mesh.h"

/**
 * Sets in a window the voxels whose winding number is above 1/2; of those asked about, if not all are: others
 * stay as they are.
 *
 * First by floats; bricks in which a voxel asked about comes within 0.008 of a half-integer are looked
 * at again more strictly, and voxels that are then within 0.0003 of it by doubles. Within 10^-6 of one half a
 * voxel is outside.
 *
 * @param asked      words of the voxels to ask about, laid out as the window's; NULL = all, and the window's
 * words are replaced
 * @param confidence NULL, or a byte per voxel of the whole grid, x fastest: of those asked about it becomes
 * 255 min(1, |2 w - 1|). The window is then a whole grid
 * @param workspace  lent
 * @param added      becomes true if a voxel is newly set
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * The same bits for any number of threads, and however a grid is cut into windows: a brick of two windows may
 * be looked at again in one of them alone, but what is not in doubt is on the same side of a half either way,
 * as the errors of floats, told in winding_walk.h, are less than half of 0.008.
 */
vxm_status vxm_winding_fill(vxm_winding_mesh *mesh, const vxm_window *window, const uint64_t *asked,
                            uint8_t *confidence, vxm_workspace *workspace, bool *added, vxm_error *error);

#endif
