/* SPDX-License-Identifier: BSD-3-Clause */
/** The distance from voxel centres to the faces of a mesh. */
#ifndef VXM_VOXEL_FIELDS_DISTANCE_H
#define VXM_VOXEL_FIELDS_DISTANCE_H

#include "voxel/fields/distance_search.h"
#include "voxel/fields/field.h"

/**
 * Makes the distances of a model, as many slices at a time as fit.
 *
 * @param report  its times are not set
 * @param options checked
 * @return as vxm_model_distance in voxmend.h; what `put` returns
 */
vxm_status vxm_distance_run(const vxm_field_target *target, vxm_distance_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_distance_options *options, vxm_error *error);

/** How vxm_distance_run goes about it; `is_whole`: the values are the caller's. */
vxm_status vxm_distance_plan(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, bool is_whole, const vxm_distance_options *options,
                             vxm_error *error);

#endif
