/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Parity of crossings along an axis (Schwarz & Seidel 2010, section 4.1).
 *
 * For each part on its own, every triangle flips in each column it covers the first voxel whose centre lies
 * beyond it; a prefix XOR along the axis then leaves the voxels that have an odd number of triangles before
 * them.
 */
#ifndef VXM_VOXEL_PARITY_H
#define VXM_VOXEL_PARITY_H

#include "voxel/slabs.h"

/** Sets in `grid` every voxel inside at least one of the job's parts; the job's axes.w is the axis. Exact. */
vxm_status vxm_parity_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_error *error);

#endif
