/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxelizing straight into a file, window after window. */
#ifndef VXM_EXPORT_MODEL_WRITER_H
#define VXM_EXPORT_MODEL_WRITER_H

#include "voxel/model/model.h"

/** See vxm_model_estimate in voxmend.h. */
vxm_status vxm_model_writer_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                     const char *path, const char *format, vxm_error *error);

/** See vxm_model_write in voxmend.h; `report` is not NULL. */
vxm_status vxm_model_writer_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                                  const char *path, const vxm_grid_write_options *options, vxm_error *error);

#endif
