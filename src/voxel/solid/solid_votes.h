/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid by votes: what one axis settles, who votes on the parts that stay open, and what of it the
 * winding number of these parts decides. */
#ifndef VXM_VOXEL_SOLID_SOLID_VOTES_H
#define VXM_VOXEL_SOLID_SOLID_VOTES_H

#include "voxel/solid/voxel_pass.h"

/** Replaces the words of a window by the solid, as vxm_solid_fill does for a method that has voters. */
vxm_status vxm_solid_vote(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error);
/**
 * Takes the axes that abstain (voxel/parity/odd_lines.h) out of the votes on some parts.
 *
 * @param voters words of a window by x, y and z parity of these parts
 */
vxm_status vxm_solid_leave_out_abstainers(vxm_voxel_pass *pass, const vxm_window *window, size_t part_begin,
                                          size_t part_end, uint64_t *const voters[3], vxm_error *error);

#endif
