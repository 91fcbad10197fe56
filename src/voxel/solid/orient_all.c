/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/orient_all.h"
#include "voxel/solid/orient_open.h"
#include "voxel/solid/solid_votes.h"

static vxm_status find(vxm_facings *out, const vxm_mesh_analysis *analysis, void *payload, vxm_error *error) {
  vxm_workspace *workspace = payload;
  vxm_orient_pass look = {.window = {.words = NULL}};
  uint64_t *solid = NULL;
  vxm_status status = vxm_orient_pass_begin(&look, analysis, workspace, error);
  if (status == VXM_OK) {
    vxm_error local = VXM_ERROR_INIT;
    size_t words = look.window.slice_words * (size_t)(look.window.end - look.window.begin);
    look.window.words = solid = vxm_alloc(workspace->context, words, sizeof *solid, &local);
    status = local.code;
    if (status != VXM_OK)
      vxm_error_pass(error, &local);
  }
  if (status == VXM_OK)
    status = vxm_solid_vote(&look.pass, &look.window, error);
  const uint64_t *const voters[3] = {solid, solid, solid};
  if (status == VXM_OK)
    status = vxm_orient_patches_find(out, &analysis->triangles, &look.pass.placed, 0,
                                     analysis->triangles.split.part_count, voters, false, error);
  vxm_free(workspace->context, solid);
  vxm_voxel_pass_destroy(&look.pass);
  return status;
}

vxm_status vxm_orient_all(const vxm_winding_chain **out, const vxm_mesh_analysis *analysis,
                          vxm_workspace *workspace, vxm_error *error) {
  return vxm_chain_once_get(out, &analysis->orientation->all, analysis, find, workspace, error);
}
