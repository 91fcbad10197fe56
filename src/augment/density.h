/* SPDX-License-Identifier: BSD-3-Clause */
/** How much of each voxel of a variant is filled, from a window of sub-voxels. */
#ifndef VXM_AUGMENT_DENSITY_H
#define VXM_AUGMENT_DENSITY_H

#include "grid/window.h"
#include "voxmend/sampler.h"

/**
 * Writes the shares of all voxels in the order of the window, by the rounding of vxm_model_coverage.
 *
 * @param n      2, 4 or 8 sub-voxels along each axis, of which the window has whole voxels
 * @param voxels VXM_VOXEL_FORMAT_UINT8 or VXM_VOXEL_FORMAT_FLOAT32
 */
void vxm_density_write(void *out, vxm_context *context, const vxm_window *window, int n,
                       vxm_voxel_format voxels);

#endif
