/* SPDX-License-Identifier: BSD-3-Clause */
/** A mesh made ready for voxelizing: its analysis, which all threads share, and passes that point to it. */
#ifndef VXM_VOXEL_MODEL_MODEL_H
#define VXM_VOXEL_MODEL_MODEL_H

#include "voxel/model/model_pass.h"
#include "voxel/model/model_results.h"

struct vxm_model {
  vxm_context *context; /**< one reference held */
  vxm_voxelize_options options;
  vxm_mesh_analysis analysis;
  vxm_model_results *results;
  pthread_mutex_t mutex; /**< of `idle` */
  vxm_model_pass *idle;  /**< passes that wait for a use: as many as there were threads at once */
};

/** See vxm_model_create in voxmend.h; the options have been checked. */
vxm_status vxm_model_make(vxm_model **out, const vxm_soup *soup, const vxm_voxelize_options *options,
                          vxm_error *error);

/**
 * Begins a pass: places the mesh on the lattice of a grid.
 *
 * @param[out] out   for vxm_model_pass_fill and vxm_model_report, until vxm_model_close; NULL after a failure
 * @param confidence NULL, or a byte per voxel to be filled; then the grid is filled as one window
 * @return as vxm_model_voxelize
 */
vxm_status vxm_model_begin(vxm_model_pass **out, vxm_model *model, const vxm_space *space,
                           const double transform[12], uint8_t *confidence, vxm_error *error);
/** As vxm_model_begin, on a lattice that may be coarser than that of its space needs to be. */
vxm_status vxm_model_begin_on(vxm_model_pass **out, vxm_model *model, const vxm_lattice *lattice,
                              const double transform[12], uint8_t *confidence, vxm_error *error);
/** Gives a pass back, whose memory is kept for the next; NULL is allowed. */
void vxm_model_close(vxm_model *model, vxm_model_pass *pass);

#endif
