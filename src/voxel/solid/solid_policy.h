/* SPDX-License-Identifier: BSD-3-Clause */
/** What options and parts say of a solid: whether holes are capped, which parts one axis settles, and on
 * which ones voters are asked. */
#ifndef VXM_VOXEL_SOLID_SOLID_POLICY_H
#define VXM_VOXEL_SOLID_SOLID_POLICY_H

#include "voxel/solid/mesh_analysis.h"

/** Whether faces set voxels, of themselves rather than as the shell of a solid. */
bool vxm_faces_wanted(const vxm_voxelize_options *options);
/** Whether the solid is needed. */
bool vxm_solid_wanted(const vxm_voxelize_options *options);
/** Whether only the shell of the solid is wanted; with the solid it is the solid. */
bool vxm_shell_wanted(const vxm_voxelize_options *options);
/** Whether holes are capped: only where no rule of the papers was asked for. */
bool vxm_caps_wanted(const vxm_voxelize_options *options);
/** Whether thin parts are kept: 0, or 6 or 26 as for vxm_thin_add. */
int vxm_thin_separating(const vxm_voxelize_options *options);
/** Whether the method is one voter for all parts. */
bool vxm_one_voter(const vxm_voxelize_options *options);
/** The first part of those that voters decide. If there are any, they have odd edges. */
size_t vxm_voted_begin(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options);
/** Whether voters decide some parts, where there is not one for all. */
bool vxm_votes_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options);
/** Whether parts that lie in themselves are to be filled where parity leaves them hollow: where no rule of
 * the papers was asked for, and the winding number is not asked about all voxels anyway. */
bool vxm_fills_overlaps(const vxm_voxelize_options *options);
/** Whether there are such parts, and they are filled. */
bool vxm_overlaps_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options);
/** Windows that a pass holds beside its result. */
int vxm_buffers_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options);
/** Whether a pass needs apexes placed. */
bool vxm_apexes_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options);

#endif
