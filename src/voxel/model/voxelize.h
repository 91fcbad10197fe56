/* SPDX-License-Identifier: BSD-3-Clause */
/** One grid of a mesh. */
#ifndef VXM_VOXEL_MODEL_VOXELIZE_H
#define VXM_VOXEL_MODEL_VOXELIZE_H

#include "voxel/model/model.h"

/** See vxm_voxelize in voxmend.h; the space is chosen and the options are checked. `report` is filled. */
vxm_status vxm_voxelize_run(vxm_grid **out, vxm_voxelize_report *report, const vxm_soup *soup,
                            const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error);

/** A new grid of a model; `report` is filled. */
vxm_status vxm_voxelize_grid(vxm_grid **out, vxm_voxelize_report *report, vxm_model *model,
                             const vxm_space *space, vxm_error *error);

/** See vxm_model_voxelize; the arguments are not NULL, except report and transform. */
vxm_status vxm_voxelize_into(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                             const double transform[12], vxm_error *error);

#endif
