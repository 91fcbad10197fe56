/* SPDX-License-Identifier: BSD-3-Clause */
/** Files of a colour per voxel. */
#ifndef VXM_EXPORT_COLORS_H
#define VXM_EXPORT_COLORS_H

#include "voxel/labels/color.h"

/** As vxm_colors_run, from a volume too. */
vxm_status vxm_colors_make(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const vxm_color_options *options, vxm_error *error);

/** Makes the colours of a model into a file. @return as vxm_model_write_colors in voxmend.h; the options have
 * been checked */
vxm_status vxm_colors_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_color_options *options, vxm_error *error);

#endif
