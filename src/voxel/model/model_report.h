/* SPDX-License-Identifier: BSD-3-Clause */
/** What a pass tells when it has come to its end. */
#ifndef VXM_VOXEL_MODEL_MODEL_REPORT_H
#define VXM_VOXEL_MODEL_MODEL_REPORT_H

#include "voxel/model/model_pass.h"

/** Fills the report, and the pass's warnings with what there is to warn of. `voxels` and `hash` are of the
 * grid. */
void vxm_model_report(vxm_model_pass *pass, vxm_voxelize_report *report, int64_t voxels, uint64_t hash);

#endif
