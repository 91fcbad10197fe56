/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/solid_fill.h"
#include "voxel/parity/tetra.h"
#include "voxel/solid/orient_all.h"
#include "voxel/solid/orient_open.h"
#include "voxel/solid/self_overlap_fill.h"
#include "voxel/solid/solid_votes.h"
#include "voxel/winding/winding_fill.h"

#include <string.h>

/** Every voxel by the winding number. */
static vxm_status fill_by_winding(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  vxm_status status = VXM_OK;
  if (!pass->all_winding.chain) {
    const vxm_winding_chain *chain;
    status = vxm_orient_all(&chain, analysis, pass->workspace, error);
    if (status == VXM_OK)
      status = vxm_winding_mesh_place(&pass->all_winding, chain, &pass->placed, window->layout.fast,
                                      pass->mirrored, error);
  }
  if (status != VXM_OK)
    return status;
  size_t depth = (size_t)(window->end - window->begin);
  pass->winding_decided += window->fast_dim * window->middle_dim * (int64_t)depth;
  status = vxm_winding_fill(&pass->all_winding, window, NULL, pass->confidence, pass->workspace, &pass->added,
                            error);
  return status;
}

static vxm_status fill_by_one(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  size_t end = analysis->triangles.split.part_count;
  vxm_method method = pass->options.method;
  if (method != VXM_METHOD_TETRA)
    return vxm_voxel_pass_unite(pass, window, (int)method - VXM_METHOD_X, 0, end, VXM_ROLE_FACE, error);
  vxm_parity_union_job job = {.triangles = &analysis->triangles,
                              .placed = &pass->placed,
                              .part_end = end,
                              .fresh = true,
                              .has_voxels = pass->has_voxels,
                              .phase = "voxelizing tetrahedra"};
  if (vxm_voxel_pass_ops(pass) && vxm_voxel_pass_ops(pass)->unite) { /* parity with cones has the same bits */
    job.axis = window->layout.fast;
    job.roles = VXM_ROLE_FACE | VXM_ROLE_CONE;
    return vxm_voxel_pass_unite_job(pass, window, &job, error);
  }
  return vxm_tetra_unite(pass->workspace, window, &job, error);
}

static vxm_status fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  bool winding = pass->options.method == VXM_METHOD_WINDING;
  if (vxm_one_voter(&pass->options))
    return fill_by_one(pass, window, error);
  /* With the winding number votes tell what is contested, and which parts have voxels of their own. */
  bool one_closed =
      winding && analysis->triangles.split.part_count == 1 && !vxm_votes_wanted(analysis, &pass->options);
  vxm_status status = one_closed ? VXM_OK : vxm_solid_vote(pass, window, error);
  if (status == VXM_OK && winding)
    status = fill_by_winding(pass, window, error);
  else if (status == VXM_OK)
    status = vxm_self_overlap_fill(pass, window, error);
  if (status == VXM_OK && one_closed && pass->added && pass->has_voxels)
    atomic_store_explicit(&pass->has_voxels[0], 1, memory_order_relaxed);
  return status;
}

vxm_status vxm_solid_fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  int64_t contested = pass->contested, winding_decided = pass->winding_decided;
  bool added = pass->added;
  vxm_error local = VXM_ERROR_INIT;
  bool elsewhere = vxm_voxel_pass_ops(pass) != NULL;
  pass->no_vote_resume &= window->begin > 0;
  vxm_status status = fill(pass, window, &local);
  if (status != VXM_OK && elsewhere && vxm_engine_falls_back(pass->engine, &local)) {
    pass->contested = contested;
    pass->winding_decided = winding_decided;
    pass->added = added;
    pass->no_vote_resume = window->begin > 0;
    status = fill(pass, window, &local);
  }
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_solid_prepare(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options,
                             vxm_error *error) {
  vxm_workspace workspace = vxm_workspace_of(analysis->context);
  const vxm_winding_chain *chain;
  vxm_status status = VXM_OK;
  if (options->method == VXM_METHOD_WINDING)
    status = vxm_orient_all(&chain, analysis, &workspace, error);
  if (status == VXM_OK && vxm_caps_wanted(options) && vxm_votes_wanted(analysis, options))
    status = vxm_orient_open(&chain, analysis, &workspace, error);
  vxm_workspace_destroy(&workspace);
  return status;
}
