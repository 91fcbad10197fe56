/* SPDX-License-Identifier: BSD-3-Clause */
/** A colour for every set voxel (Rueda et al., section 5): by functions that are built in, or by GLSL. */
#ifndef VXM_VOXEL_LABELS_COLOR_H
#define VXM_VOXEL_LABELS_COLOR_H

#include "voxel/engine/engine.h"
#include "voxel/model/model.h"

/** Whether the voxels' parts have to be known. */
bool vxm_color_wants_parts(const vxm_color_options *options);

/**
 * The colour of a set voxel by a function that is built in, on the CPU.
 *
 * @param longest vxm_space_longest_side of the space
 * @param part    with VXM_COLOR_PART
 */
void vxm_color_voxel(uint8_t value[4], vxm_color_by by, const vxm_space *space, float longest,
                     const int64_t at[3], uint16_t part);

/**
 * Makes the colours of a model.
 *
 * @param values room for dims[0]*dims[1]*dims[2]*4 bytes, [x][y][z][4] in C order
 * @return as vxm_model_colors in voxmend.h
 */
vxm_status vxm_colors_run(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                          const vxm_space *space, const vxm_color_options *options, vxm_error *error);

#endif
