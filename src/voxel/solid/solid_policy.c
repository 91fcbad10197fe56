/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/solid_policy.h"
#include "voxel/engine/engine.h"

static bool is_shell(const vxm_voxelize_options *options) {
  return options->surface >= VXM_SURFACE_SHELL26;
}

bool vxm_faces_wanted(const vxm_voxelize_options *options) {
  return options->mode != VXM_MODE_SOLID && !is_shell(options);
}

bool vxm_solid_wanted(const vxm_voxelize_options *options) {
  return options->mode != VXM_MODE_SURFACE || is_shell(options);
}

bool vxm_shell_wanted(const vxm_voxelize_options *options) {
  return options->mode == VXM_MODE_SURFACE && is_shell(options);
}

bool vxm_caps_wanted(const vxm_voxelize_options *options) {
  return options->method == VXM_METHOD_WINDING ||
         (options->method == VXM_METHOD_VOTE && options->vote == VXM_VOTE_AUTO);
}

bool vxm_one_voter(const vxm_voxelize_options *options) {
  return options->method != VXM_METHOD_VOTE && options->method != VXM_METHOD_WINDING;
}

int vxm_thin_separating(const vxm_voxelize_options *options) {
  bool automatic = options->method == VXM_METHOD_VOTE && options->vote == VXM_VOTE_AUTO;
  if (vxm_faces_wanted(options) && options->surface == VXM_SURFACE_CONSERVATIVE)
    return 0; /* which has all that would be added */
  if (!vxm_solid_wanted(options) || options->thin == VXM_THIN_DROP ||
      (options->thin == VXM_THIN_AUTO && !automatic))
    return 0;
  return options->thin == VXM_THIN_KEEP26 ? 26 : 6;
}

size_t vxm_voted_begin(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options) {
  const vxm_split *split = &analysis->triangles.split;
  /* Where no edge is odd the axes agree (voxel/parity/parity_difference.h), and there is nothing to vote on.
   */
  bool differ = split->odd_edge_count > 0;
  bool all = options->vote_always && !vxm_caps_wanted(options) && differ;
  return all ? 0 : split->kind_end[VXM_PART_CAPPED];
}

bool vxm_votes_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options) {
  return !vxm_one_voter(options) && vxm_voted_begin(analysis, options) < analysis->triangles.split.part_count;
}

bool vxm_fills_overlaps(const vxm_voxelize_options *options) {
  return options->method == VXM_METHOD_VOTE && options->vote == VXM_VOTE_AUTO && vxm_solid_wanted(options) &&
         options->split_mode != VXM_SPLIT_MODE_WHOLE; /* which unites nothing */
}

bool vxm_overlaps_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options) {
  bool displaces = options->engine && options->engine->displaces; /* where to is not known here */
  return analysis->self_overlap.part_count > 0 && vxm_fills_overlaps(options) && !displaces;
}

int vxm_buffers_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options) {
  /* What is decided by winding numbers, two masks of bricks, and the crossings of rows that are counted: for
   * all, and for what is contested. */
  enum { WINDING = 6 };
  int winding = options->method == VXM_METHOD_WINDING ? WINDING : 0;
  winding += vxm_overlaps_wanted(analysis, options) ? WINDING : 0;
  if (!vxm_votes_wanted(analysis, options))
    return winding;
  winding += vxm_caps_wanted(options) ? WINDING : 0;
  if (vxm_voted_begin(analysis, options) + 1 == analysis->triangles.split.part_count && !options->engine)
    return winding + vxm_caps_wanted(options); /* one part: only what is contested */
  return winding + 4;                          /* three axes, and what is contested or the tetrahedra */
}

bool vxm_apexes_wanted(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options) {
  return options->method == VXM_METHOD_TETRA || options->confidence ||
         (vxm_votes_wanted(analysis, options) && !vxm_caps_wanted(options));
}
