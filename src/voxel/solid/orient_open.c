/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/orient_open.h"
#include "grid/space.h"
#include "voxel/solid/solid_votes.h"

enum { VOXELS = 256 /**< along the longest side */ };

vxm_status vxm_orient_pass_begin(vxm_orient_pass *out, const vxm_mesh_analysis *analysis,
                                 vxm_workspace *workspace, vxm_error *error) {
  /* Asking the winding number would ask for what is being looked for. */
  static const vxm_voxelize_options votes = VXM_VOXELIZE_OPTIONS_INIT;
  out->pass = vxm_voxel_pass_of(analysis, &votes, workspace);
  vxm_space_options wanted = VXM_SPACE_OPTIONS_INIT;
  wanted.resolution[0] = VOXELS;
  wanted.pad = 2; /* the outside is asked, too */
  vxm_space space;
  vxm_status status = vxm_space_choose(&space, analysis->soup, &wanted, error);
  if (status != VXM_OK)
    return status;
  out->window = vxm_window_of(&space, (vxm_layout)VXM_LAYOUT_GRID, 0, space.dims[2]);
  vxm_lattice lattice = vxm_lattice_of(&space);
  return vxm_voxel_pass_place(&out->pass, &lattice, NULL, error);
}

/** By what three axes see of the open parts, from both ends. */
static vxm_status find(vxm_facings *out, const vxm_mesh_analysis *analysis, void *payload, vxm_error *error) {
  vxm_orient_pass look = {.window = {.words = NULL}};
  vxm_status status = vxm_orient_pass_begin(&look, analysis, payload, error);
  size_t begin = vxm_voted_begin(analysis, &look.pass.options), end = analysis->triangles.split.part_count;
  uint64_t *voters[3] = {NULL};
  for (int axis = 0; axis < 3 && status == VXM_OK; axis++) {
    vxm_window voter;
    status = vxm_voxel_pass_buffer(&look.pass, axis, &look.window, &voter, error);
    if (status == VXM_OK)
      status = vxm_voxel_pass_unite(&look.pass, &voter, axis, begin, end, VXM_ROLE_FACE, error);
    voters[axis] = voter.words;
  }
  if (status == VXM_OK)
    status = vxm_solid_leave_out_abstainers(&look.pass, &look.window, begin, end, voters, error);
  if (status == VXM_OK)
    status = vxm_orient_patches_find(out, &analysis->triangles, &look.pass.placed, begin, end,
                                     (const uint64_t *const *)voters, true, error);
  vxm_voxel_pass_destroy(&look.pass);
  return status;
}

vxm_status vxm_orient_open(const vxm_winding_chain **out, const vxm_mesh_analysis *analysis,
                           vxm_workspace *workspace, vxm_error *error) {
  return vxm_chain_once_get(out, &analysis->orientation->open, analysis, find, workspace, error);
}
