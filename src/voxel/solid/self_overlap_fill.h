/* SPDX-License-Identifier: BSD-3-Clause */
/** Filling parts that lie in themselves, where parity leaves them hollow. */
#ifndef VXM_VOXEL_SOLID_SELF_OVERLAP_FILL_H
#define VXM_VOXEL_SOLID_SELF_OVERLAP_FILL_H

#include "voxel/solid/voxel_pass.h"

/**
 * Sets in a window the voxels around which the parts that lie in themselves (winding/self_overlap.h) are
 * wound at least once; others stay as they are. Nothing is done where vxm_overlaps_wanted says no.
 *
 * @return as vxm_chain_winding_fill
 */
vxm_status vxm_self_overlap_fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error);

/** For those who fill them otherwise: gets the pass's overlap_winding ready for rows along an axis, the same
 * in all of a pass. @return as vxm_chain_winding_place */
vxm_status vxm_self_overlap_place(vxm_voxel_pass *pass, int axis, vxm_error *error);
/** Notes that they have voxels: to be called where a voxel has been set that was not. */
void vxm_self_overlap_note(vxm_voxel_pass *pass);

#endif
