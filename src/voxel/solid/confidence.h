/* SPDX-License-Identifier: BSD-3-Clause */
/** How sure each voxel is. */
#ifndef VXM_VOXEL_SOLID_CONFIDENCE_H
#define VXM_VOXEL_SOLID_CONFIDENCE_H

#include "voxel/solid/voxel_pass.h"

/**
 * Fills in the pass's confidence what the winding number did not decide: 255 where closed parts alone are
 * asked, else 255 times the share of the voters x, y, z and tetra that agree with the solid.
 *
 * @param window a whole grid, which vxm_solid_fill has just filled
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_confidence_fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error);

#endif
