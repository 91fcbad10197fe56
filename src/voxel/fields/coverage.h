/* SPDX-License-Identifier: BSD-3-Clause */
/** How much of each voxel is filled, from sub-voxels (Schwarz & Seidel, sec. 5.5). */
#ifndef VXM_VOXEL_FIELDS_COVERAGE_H
#define VXM_VOXEL_FIELDS_COVERAGE_H

#include "voxel/fields/field.h"

/**
 * Makes the coverage of a model. The model is voxelized in voxels of an n-th of the size, a few slices at a
 * time; the finer grid is never held as a whole.
 *
 * @param report  its times are not set
 * @param options checked
 * @return as vxm_model_coverage in voxmend.h; what `put` returns
 */
vxm_status vxm_coverage_run(const vxm_field_target *target, vxm_coverage_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_coverage_options *options, vxm_error *error);

/** How vxm_coverage_run goes about it; `is_whole`: the values are the caller's. Windows are of sub-voxels. */
vxm_status vxm_coverage_plan(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, bool is_whole, const vxm_coverage_options *options,
                             vxm_error *error);

#endif
