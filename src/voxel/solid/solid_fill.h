/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid of a mesh in the windows of one grid, by the method that the options name. */
#ifndef VXM_VOXEL_SOLID_SOLID_FILL_H
#define VXM_VOXEL_SOLID_SOLID_FILL_H

#include "voxel/solid/voxel_pass.h"

/**
 * Replaces the words of a window by the solid. Windows come in order, each where the last one ended.
 *
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_solid_fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error);

/**
 * Finds out now what vxm_solid_fill might only later ask an analysis for, in the middle of a pass: which way
 * its triangles face. For passes of many threads that must not wait for each other.
 *
 * @return as vxm_solid_fill
 */
vxm_status vxm_solid_prepare(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options,
                             vxm_error *error);

#endif
