/* SPDX-License-Identifier: BSD-3-Clause */
/** Combining voters voxel by voxel. */
#ifndef VXM_VOXEL_VOTE_H
#define VXM_VOXEL_VOTE_H

#include "grid/bitgrid.h"

/**
 * Adds to `out` the voxels that the four voters elect, and counts those on which they disagree and that `out`
 * did not hold before (what a closed part fills is not in question).
 *
 * VXM_VOTE_MAJORITY elects what at least two of x, y and z hold (Chen & Tu, section 2.3). The tetrahedral
 * voter cannot change that: with it on the side of the axes' minority the four are at most two against two,
 * and a tie goes to the axes.
 *
 * @param voters x, y, z and tetra, of the dimensions of `out`
 * @param rule   VXM_VOTE_MAJORITY, VXM_VOTE_ANY or VXM_VOTE_ALL
 */
void vxm_vote_combine(vxm_grid *out, vxm_grid *const voters[4], vxm_vote rule, int64_t *contested);

/**
 * Adds to `out` the voxels that all three voters hold, sets in `contested` those on which they disagree and
 * that `out` did not hold before, and counts them.
 */
void vxm_vote_agree(vxm_grid *out, vxm_grid *const voters[3], vxm_grid *contested, int64_t *count);

#endif
