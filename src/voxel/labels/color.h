/* SPDX-License-Identifier: BSD-3-Clause */
/** A colour for every set voxel (Rueda et al., section 5): by functions that are built in, or by GLSL. */
#ifndef VXM_VOXEL_LABELS_COLOR_H
#define VXM_VOXEL_LABELS_COLOR_H

#include "voxel/engine/engine.h"
#include "voxel/model/model.h"

/** Whether the voxels' parts have to be known. */
bool vxm_color_wants_parts(const vxm_color_options *options);

/**
 * Makes the colours of a model.
 *
 * @param values room for dims[0]*dims[1]*dims[2]*4 bytes, [x][y][z][4] in C order
 * @return as vxm_model_colors in voxmend.h
 */
vxm_status vxm_colors_run(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                          const vxm_space *space, const vxm_color_options *options, vxm_error *error);

#endif
