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

/** Where values go: into an array of the caller's, into slices that are handed on, or into tiles. */
typedef enum vxm_distance_way {
  VXM_DISTANCE_WHOLE,
  VXM_DISTANCE_SLICES,
  VXM_DISTANCE_TILES
} vxm_distance_way;

/** How a target takes distances; `takes_tiles`: it would if it can. */
vxm_distance_way vxm_distance_way_of(bool is_whole, bool takes_tiles, const vxm_distance_options *options);

/** How vxm_distance_run goes about it. */
vxm_status vxm_distance_plan(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, vxm_distance_way way, const vxm_distance_options *options,
                             vxm_error *error);

#endif
