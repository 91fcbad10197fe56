/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/voxel_pass.h"

vxm_voxel_pass vxm_voxel_pass_of(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options,
                                 vxm_workspace *workspace) {
  vxm_context *context = workspace->context;
  return (vxm_voxel_pass){.context = context,
                          .analysis = analysis,
                          .options = *options,
                          .workspace = workspace,
                          .engine = options->engine,
                          .placed = {.context = context},
                          .open_winding = vxm_winding_mesh_of(context),
                          .all_winding = vxm_winding_mesh_of(context),
                          .overlap_winding = {.context = context}};
}

void vxm_voxel_pass_destroy(vxm_voxel_pass *pass) {
  for (int b = 0; b < VXM_BUFFERS; b++)
    vxm_free(pass->context, pass->buffers[b].words);
  vxm_snapped_points_destroy(&pass->placed);
  vxm_winding_mesh_destroy(&pass->open_winding);
  vxm_winding_mesh_destroy(&pass->all_winding);
  vxm_chain_winding_destroy(&pass->overlap_winding);
}

void vxm_voxel_pass_begin(vxm_voxel_pass *pass) {
  size_t parts = pass->has_voxels ? pass->analysis->triangles.split.part_count : 0;
  for (size_t p = 0; p < parts; p++)
    atomic_store_explicit(&pass->has_voxels[p], 0, memory_order_relaxed);
  pass->contested = pass->winding_decided = 0;
  pass->added = false;
  pass->open_winding.chain = pass->all_winding.chain = NULL;
  pass->overlap_placed = false;
}

vxm_status vxm_voxel_pass_buffer(vxm_voxel_pass *pass, int buffer, const vxm_window *like, vxm_window *out,
                                 vxm_error *error) {
  vxm_buffer *b = &pass->buffers[buffer];
  size_t count = like->slice_words * (size_t)(like->end - like->begin);
  vxm_status status = vxm_renew(pass->context, (void **)&b->words, &b->count, count, sizeof *b->words, error);
  *out = *like;
  out->words = b->words;
  return status;
}

/* ---- What another engine may do ---- */

static vxm_status move_elsewhere(vxm_voxel_pass *pass, const vxm_lattice *lattice, bool apexes, bool *done,
                                 vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_move_job job = {&pass->analysis->triangles, pass->motion, apexes};
  vxm_status status = vxm_snapped_points_begin(&pass->placed, job.triangles, lattice, pass->motion, error);
  if (status != VXM_OK)
    return status;
  status = vxm_voxel_pass_ops(pass)->move(pass->engine, &pass->placed, &job, done, &local);
  *done &= status == VXM_OK;
  if (status == VXM_OK || vxm_engine_falls_back(pass->engine, &local))
    return VXM_OK;
  vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_voxel_pass_place(vxm_voxel_pass *pass, const vxm_lattice *lattice, const double transform[12],
                                vxm_error *error) {
  const vxm_triangle_set *triangles = &pass->analysis->triangles;
  const vxm_engine_ops *ops = vxm_voxel_pass_ops(pass);
  bool apexes = pass->confidence || vxm_apexes_wanted(pass->analysis, &pass->options) ||
                (pass->engine && pass->engine->wants_apexes);
  bool done = false;
  if (!pass->motion)
    return vxm_snapped_points_set(&pass->placed, triangles, lattice, transform, apexes, error);
  vxm_status status = ops && ops->move ? move_elsewhere(pass, lattice, apexes, &done, error) : VXM_OK;
  return status == VXM_OK && !done
             ? vxm_snapped_points_move(&pass->placed, triangles, lattice, pass->motion, apexes, error)
             : status;
}

vxm_status vxm_voxel_pass_unite_job(vxm_voxel_pass *pass, const vxm_window *window,
                                    const vxm_parity_union_job *job, vxm_error *error) {
  const vxm_engine_ops *ops = vxm_voxel_pass_ops(pass);
  if (ops && ops->unite)
    return ops->unite(pass->engine, window, job, error);
  return vxm_parity_union(pass->workspace, window, job, error);
}

vxm_status vxm_voxel_pass_unite(vxm_voxel_pass *pass, const vxm_window *window, int axis, size_t part_begin,
                                size_t part_end, unsigned roles, vxm_error *error) {
  static const char *const phase[3] = {"voxelizing along x", "voxelizing along y", "voxelizing along z"};
  vxm_parity_union_job job = {.triangles = &pass->analysis->triangles,
                              .placed = &pass->placed,
                              .axis = axis,
                              .part_begin = part_begin,
                              .part_end = part_end,
                              .roles = roles,
                              .fresh = true,
                              .has_voxels = pass->has_voxels,
                              .phase = phase[axis]};
  return vxm_voxel_pass_unite_job(pass, window, &job, error);
}

vxm_status vxm_voxel_pass_surface(vxm_voxel_pass *pass, const vxm_surface *surface, const vxm_window *window,
                                  vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  const vxm_engine_ops *ops = vxm_voxel_pass_ops(pass);
  if (ops && ops->surface) {
    vxm_error local = VXM_ERROR_INIT;
    vxm_status status = ops->surface(pass->engine, surface, window, kind, is_fresh, &local);
    if (status == VXM_OK)
      return VXM_OK;
    if (!vxm_engine_falls_back(pass->engine, &local)) {
      vxm_error_pass(error, &local);
      return status;
    }
  }
  return vxm_surface_add(surface, window, kind, is_fresh, error);
}
