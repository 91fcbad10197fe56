/* SPDX-License-Identifier: BSD-3-Clause */
/** A mesh made ready for voxelizing: its shape, and the run over the present grid. */
#ifndef VXM_VOXEL_MODEL_MODEL_H
#define VXM_VOXEL_MODEL_MODEL_H

#include "voxel/parts/face_labels.h"
#include "voxel/solid/solid_policy.h"
#include "voxel/surface/shell_window.h"
#include "voxel/surface/surface.h"

struct vxm_model {
  vxm_context *context; /**< one reference held */
  vxm_voxelize_options options;
  vxm_mesh_analysis shape;
  vxm_voxel_pass run;
  vxm_surface *surface; /**< of the present run; NULL before the first that wants it */
  vxm_shell_window shelling;
  vxm_space space;        /**< of the present run */
  vxm_warnings warnings;  /**< of the last run */
  vxm_label_table labels; /**< of the last run that made labels */
};

/** See vxm_model_create in voxmend.h; the options have been checked. */
vxm_status vxm_model_make(vxm_model **out, const vxm_soup *soup, const vxm_voxelize_options *options,
                          vxm_error *error);

/** What a run takes at most, beside the points of the mesh: `fixed` bytes, and `windows` times the words of
 * the windows it fills, the result included. */
typedef struct vxm_memory_need {
  uint64_t fixed;
  int windows;
} vxm_memory_need;

/** What a run over windows of this shape takes if the crossings of triangles stay below their bound; or,
 * where `worst`, if all of them become bitmaps, of which each thread may have several. */
vxm_memory_need vxm_model_memory_need(const vxm_model *model, const vxm_space *space, const vxm_window *shape,
                                      bool worst);
/** Whether faces set voxels, and whether the solid is needed. */
bool vxm_model_wants_faces(const vxm_model *model);
bool vxm_model_wants_solid(const vxm_model *model);
/** Windows of words that a run over a whole grid holds at once, its result included. */
int vxm_model_windows_held(const vxm_model *model);

/**
 * Begins a run: places the mesh on the lattice of a grid.
 *
 * @param confidence NULL, or a byte per voxel to be filled; then the grid is filled as one window
 * @return as vxm_model_voxelize
 */
vxm_status vxm_model_begin(vxm_model *model, const vxm_space *space, const double transform[12],
                           uint8_t *confidence, vxm_error *error);
/** As vxm_model_begin, on a lattice that may be coarser than that of its space needs to be. */
vxm_status vxm_model_begin_on(vxm_model *model, const vxm_lattice *lattice, const double transform[12],
                              uint8_t *confidence, vxm_error *error);
/** Replaces the words of a window of the run's grid. Windows come in order, each where the last one ended. */
vxm_status vxm_model_fill(vxm_model *model, const vxm_window *window, vxm_error *error);
/** Ends a run: fills the report, and warnings what there is to warn of. `voxels` and `hash` are of the grid.
 */
void vxm_model_end(vxm_model *model, vxm_voxelize_report *report, int64_t voxels, uint64_t hash);

#endif
