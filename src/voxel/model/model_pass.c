/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model_pass.h"
#include "grid/shell.h"
#include "voxel/solid/confidence.h"
#include "voxel/solid/solid_fill.h"

#include <math.h>
#include <string.h>

void vxm_model_pass_start(vxm_model_pass *pass, vxm_context *context) {
  static const vxm_voxelize_options none = VXM_VOXELIZE_OPTIONS_INIT;
  *pass = (vxm_model_pass){.workspace = vxm_workspace_of(context), .thin.thin.context = context};
  pass->solid = vxm_voxel_pass_of(NULL, &none, &pass->workspace);
}

vxm_status vxm_model_pass_attach(vxm_model_pass *pass, const vxm_mesh_analysis *analysis,
                                 const vxm_voxelize_options *options, vxm_error *error) {
  vxm_voxel_pass *solid = &pass->solid;
  vxm_surface_destroy(pass->surface);
  pass->surface = NULL;
  solid->analysis = analysis;
  solid->options = *options;
  solid->engine = options->engine;
  size_t parts = analysis->triangles.split.part_count;
  return vxm_renew(solid->context, (void **)&solid->has_voxels, &pass->part_capacity, parts,
                   sizeof *solid->has_voxels, error);
}

void vxm_model_pass_end(vxm_model_pass *pass) {
  vxm_context *context = pass->solid.context;
  vxm_surface_destroy(pass->surface);
  vxm_free(context, pass->solid.has_voxels);
  vxm_voxel_pass_destroy(&pass->solid);
  vxm_slice_buffer_destroy(&pass->shell_solid, context);
  vxm_thin_window_destroy(&pass->thin);
  vxm_workspace_destroy(&pass->workspace);
}

static vxm_status check_transform(const double m[12], bool *mirrored, vxm_error *error) {
  for (int i = 0; i < 12; i++)
    if (!isfinite(m[i]))
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: element %d of the transform is not finite", i);
  double determinant = 0;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    determinant += m[a] * (m[4 + b] * m[8 + c] - m[4 + c] * m[8 + b]);
  }
  if (determinant == 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "voxelize: the transform has determinant 0: it flattens the mesh");
  *mirrored = determinant < 0;
  return VXM_OK;
}

static vxm_status place_surface(vxm_model_pass *pass, const vxm_lattice *lattice, const double transform[12],
                                vxm_error *error) {
  vxm_status status = VXM_OK;
  if (!pass->surface)
    status = vxm_surface_make(&pass->surface, pass->solid.context, pass->solid.analysis->soup, error);
  if (status != VXM_OK)
    return status;
  return pass->vertices ? vxm_surface_place_moved(pass->surface, pass->vertices, lattice, error)
                        : vxm_surface_place(pass->surface, lattice, transform, error);
}

vxm_status vxm_model_pass_place(vxm_model_pass *pass, const vxm_lattice *lattice, const double transform[12],
                                uint8_t *confidence, vxm_error *error) {
  vxm_voxel_pass *solid = &pass->solid;
  pass->space = lattice->space;
  bool displaces = solid->engine && solid->engine->displaces; /* where to is not known here */
  pass->separating = displaces ? 0 : vxm_thin_separating(&pass->solid.options);
  pass->is_field = false;
  pass->transform = transform;
  solid->mirrored = false;
  vxm_status status = transform ? check_transform(transform, &solid->mirrored, error) : VXM_OK;
  if (status != VXM_OK)
    return status;
  vxm_voxel_pass_begin(solid);
  solid->confidence = confidence;
  vxm_slice_buffer_begin(&pass->shell_solid);
  vxm_thin_window_begin(&pass->thin);
  if (vxm_solid_wanted(&solid->options))
    status = vxm_voxel_pass_place(solid, lattice, transform, error);
  return status == VXM_OK && vxm_faces_wanted(&solid->options)
             ? place_surface(pass, lattice, transform, error)
             : status;
}

/** The voxels whose centre is inside. */
static vxm_status fill_centres(const vxm_window *window, void *payload, vxm_error *error) {
  vxm_voxel_pass *solid = payload;
  vxm_status status = vxm_solid_fill(solid, window, error);
  return status == VXM_OK && solid->confidence ? vxm_confidence_fill(solid, window, error) : status;
}

static vxm_status fill_solid(const vxm_window *window, void *payload, vxm_error *error) {
  vxm_model_pass *pass = payload;
  vxm_voxel_pass *solid = &pass->solid;
  vxm_thin_grid grid = {.triangles = &solid->analysis->triangles,
                        .placed = &solid->placed,
                        .separating = pass->separating,
                        .confidence = solid->confidence,
                        .fill = fill_centres,
                        .payload = solid};
  return grid.separating ? vxm_thin_window_fill(&pass->thin, window, &grid, error)
                         : fill_centres(window, solid, error);
}

static vxm_status fill_shell(vxm_model_pass *pass, const vxm_window *window, vxm_error *error) {
  static const vxm_adjacency adjacency[] = {[VXM_SURFACE_SHELL26] = VXM_ADJACENT_26,
                                            [VXM_SURFACE_SHELL18] = VXM_ADJACENT_18,
                                            [VXM_SURFACE_SHELL6] = VXM_ADJACENT_6};
  vxm_window solid;
  vxm_status status = vxm_slice_buffer_fill(&pass->shell_solid, &solid, window, 1, fill_solid, pass,
                                            pass->solid.context, error);
  if (status == VXM_OK)
    vxm_shell_fill(window, &solid, adjacency[pass->solid.options.surface], pass->solid.context);
  return status;
}

vxm_status vxm_model_pass_fill(vxm_model_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_voxelize_options *options = &pass->solid.options;
  uint8_t *confidence = pass->solid.confidence;
  if (vxm_shell_wanted(options))
    return fill_shell(pass, window, error);
  bool solid = vxm_solid_wanted(options);
  vxm_status status = solid ? fill_solid(window, pass, error) : VXM_OK;
  if (status != VXM_OK || !vxm_faces_wanted(options))
    return status;
  if (solid && confidence)
    return vxm_surface_add_sure(pass->surface, window, options->surface, confidence, error);
  if (confidence) /* exact everywhere */
    memset(confidence, 255, (size_t)window->fast_dim * (size_t)window->middle_dim * (size_t)window->slow_dim);
  return vxm_voxel_pass_surface(&pass->solid, pass->surface, window, options->surface, !solid, error);
}
