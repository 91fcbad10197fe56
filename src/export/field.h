/* SPDX-License-Identifier: BSD-3-Clause */
/** Files of a number per voxel. */
#ifndef VXM_EXPORT_FIELD_H
#define VXM_EXPORT_FIELD_H

#include "voxel/fields/coverage.h"
#include "voxel/fields/distance.h"

/**
 * Makes the coverage of a model into a file. Slices are written as they are made, in the order of the file.
 *
 * @return as vxm_model_write_coverage in voxmend.h; the options have been checked
 */
vxm_status vxm_field_write_coverage(vxm_coverage_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_coverage_options *options, vxm_error *error);

/** The same for the distance. */
vxm_status vxm_field_write_distance(vxm_distance_report *report, vxm_model *model, const vxm_space *space,
                                    const char *path, const vxm_distance_options *options, vxm_error *error);

/** See vxm_model_estimate_coverage and vxm_model_estimate_distance in voxmend.h; the options have been
 * checked.
 */
vxm_status vxm_field_estimate_coverage(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_coverage_options *options,
                                       vxm_error *error);
vxm_status vxm_field_estimate_distance(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                                       const char *path, const vxm_distance_options *options,
                                       vxm_error *error);

#endif
