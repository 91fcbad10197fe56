/* SPDX-License-Identifier: BSD-3-Clause */
/** A pass over one grid: the solid, the faces, the shell, or several of them, window after window. */
#ifndef VXM_VOXEL_MODEL_MODEL_PASS_H
#define VXM_VOXEL_MODEL_MODEL_PASS_H

#include "base/warnings.h"
#include "voxel/solid/voxel_pass.h"
#include "voxel/surface/surface.h"
#include "voxel/thin/thin_window.h"

/** Stays where it is in memory. Start with vxm_model_pass_start. */
typedef struct vxm_model_pass {
  vxm_voxel_pass solid; /**< has the options, too, and points to the mesh's analysis */
  vxm_workspace workspace;
  size_t part_capacity;         /**< of solid.has_voxels */
  vxm_surface *surface;         /**< NULL before the first grid that wants it */
  const double (*vertices)[3];  /**< where the soup's have moved to; NULL = nowhere */
  const double *transform;      /**< of the grid that is made; NULL = none */
  vxm_slice_buffer shell_solid; /**< the solid around a window of its shell */
  vxm_thin_window thin;
  int separating; /**< what vxm_thin_separating says of the options; 0 where only centres are asked for */
  bool is_field;  /**< numbers are made of the voxels, in which thin parts play no part */
  vxm_space space;
  vxm_warnings *warnings;      /**< NULL = not asked for */
  struct vxm_model_pass *next; /**< of those that wait for a use */
} vxm_model_pass;

/** After vxm_model_pass_place: shares and signs are those of the solid itself. */
static inline void vxm_model_pass_make_field(vxm_model_pass *pass) {
  pass->is_field = true;
  pass->separating = 0;
}

void vxm_model_pass_start(vxm_model_pass *pass, vxm_context *context);
/** Points the pass to an analysis, which must outlive its use, and keeps its memory for that. */
vxm_status vxm_model_pass_attach(vxm_model_pass *pass, const vxm_mesh_analysis *analysis,
                                 const vxm_voxelize_options *options, vxm_error *error);
void vxm_model_pass_end(vxm_model_pass *pass);

/** Places the mesh on the lattice of a grid; `confidence` is as in vxm_model_begin. */
vxm_status vxm_model_pass_place(vxm_model_pass *pass, const vxm_lattice *lattice, const double transform[12],
                                uint8_t *confidence, vxm_error *error);
/** Replaces the words of a window of the grid. Windows come in order, each where the last one ended. */
vxm_status vxm_model_pass_fill(vxm_model_pass *pass, const vxm_window *window, vxm_error *error);

#endif
