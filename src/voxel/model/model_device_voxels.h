/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels of a model that stay on its engine's device. */
#ifndef VXM_VOXEL_MODEL_MODEL_DEVICE_VOXELS_H
#define VXM_VOXEL_MODEL_MODEL_DEVICE_VOXELS_H

#include "voxel/model/model.h"

/** Makes room for `count` grids of a space on the device of an engine, which may be NULL. @return as
 * vxm_model_voxelize_device */
vxm_status vxm_device_voxels_create(vxm_device_voxels **out, vxm_engine *engine, const vxm_space *space,
                                    int64_t count, vxm_voxel_format format, vxm_error *error);

/** Makes the grid of a pass that has been placed into grid `index` of such room. */
vxm_status vxm_model_pass_keep_on_device(vxm_model_pass *pass, vxm_device_voxels *voxels, int64_t index,
                                         vxm_error *error);

/** See vxm_model_voxelize_device in voxmend/experimental.h; the space has been checked. */
vxm_status vxm_voxelize_on_device(vxm_device_voxels **out, vxm_model *model, const vxm_space *space,
                                  const double transform[12], vxm_voxel_format format, vxm_error *error);

#endif
