/* SPDX-License-Identifier: BSD-3-Clause */
/** A mesh made ready for voxelizing: its shape, and the run over the present grid. */
#ifndef VXM_VOXEL_MODEL_H
#define VXM_VOXEL_MODEL_H

#include "voxel/solid.h"

struct vxm_model {
  vxm_context *context; /**< one reference held */
  vxm_voxelize_options options;
  vxm_shape shape;
  vxm_run run;
  vxm_space space; /**< of the present run */
  vxm_notes notes; /**< of the last run */
};

/** See vxm_model_create in voxmend.h; the options have been checked. */
vxm_status vxm_model_make(vxm_model **out, const vxm_soup *soup, const vxm_voxelize_options *options,
                          vxm_error *error);

/** Windows of words that a run holds at once, its result included. */
int vxm_model_windows_held(const vxm_model *model);

/**
 * Begins a run: places the mesh on the lattice of a grid.
 *
 * @param confidence NULL, or a byte per voxel to be filled; then the grid is filled as one window
 * @return as vxm_model_voxelize
 */
vxm_status vxm_model_begin(vxm_model *model, const vxm_space *space, const double transform[12],
                           uint8_t *confidence, vxm_error *error);
/** Replaces the words of a window of the run's grid. */
vxm_status vxm_model_fill(vxm_model *model, const vxm_window *window, vxm_error *error);
/** Ends a run: fills the report, and notes what there is to warn of. `voxels` and `hash` are of the grid. */
void vxm_model_end(vxm_model *model, vxm_voxelize_report *report, int64_t voxels, uint64_t hash);

#endif
