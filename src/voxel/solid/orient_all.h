/* SPDX-License-Identifier: BSD-3-Clause */
/** All parts, turned outward by the solid that votes make in a grid of fixed resolution. */
#ifndef VXM_VOXEL_SOLID_ORIENT_ALL_H
#define VXM_VOXEL_SOLID_ORIENT_ALL_H

#include "voxel/solid/voxel_pass.h"

/** The chain of all parts; otherwise as vxm_orient_open. */
vxm_status vxm_orient_all(const vxm_winding_chain **out, const vxm_mesh_analysis *analysis,
                          vxm_workspace *workspace, vxm_error *error);

#endif
