/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/orient_by_vote.h"
#include "grid/space.h"

#include <string.h>

enum { VOXELS = 256 /**< along the longest side */ };

/** A run over a grid of fixed resolution, and that grid. */
typedef struct look {
  vxm_voxelize_options options;
  vxm_voxel_pass run;
  vxm_window window;
} look;

static vxm_status look_begin(look *out, vxm_mesh_analysis *shape, vxm_error *error) {
  vxm_context *context = shape->context;
  out->run = (vxm_voxel_pass){.shape = shape, .placed = {.context = context}};
  out->run.open_wound.context = out->run.all_wound.context = context;
  vxm_space_options wanted = VXM_SPACE_OPTIONS_INIT;
  wanted.resolution[0] = VOXELS;
  wanted.pad = 2; /* the outside is asked, too */
  vxm_space space;
  vxm_status status = vxm_space_choose(&space, shape->soup, &wanted, error);
  if (status != VXM_OK)
    return status;
  out->window = vxm_window_of(&space, (vxm_layout)VXM_LAYOUT_GRID, 0, space.dims[2]);
  vxm_lattice lattice = vxm_lattice_of(&space);
  return vxm_snapped_points_set(&out->run.placed, &shape->facets, &lattice, NULL,
                                vxm_voxel_pass_apexes(shape), error);
}

vxm_status vxm_orient_open(vxm_mesh_analysis *shape, vxm_error *error) {
  if (shape->open_turns.turned)
    return VXM_OK;
  look l = {0};
  vxm_status status = look_begin(&l, shape, error);
  size_t begin = vxm_voted_begin(shape), end = shape->facets.split.part_count;
  const uint64_t *voters[3] = {NULL};
  for (int axis = 0; axis < 3 && status == VXM_OK; axis++) {
    vxm_window voter;
    status = vxm_voxel_pass_buffer(&l.run, axis, &l.window, &voter, error);
    if (status == VXM_OK)
      status = vxm_voxel_pass_unite(&l.run, &voter, axis, begin, end, VXM_FACET_TRIANGLE, error);
    voters[axis] = voter.words;
  }
  if (status == VXM_OK)
    status =
        vxm_orient_patches_find(&shape->open_turns, &shape->facets, &l.run.placed, begin, end, voters, error);
  vxm_voxel_pass_destroy(&l.run);
  return status;
}

vxm_status vxm_orient_all(vxm_mesh_analysis *shape, vxm_error *error) {
  if (shape->all_turns.turned)
    return VXM_OK;
  look l = {0};
  vxm_buffer solid = {NULL, 0};
  vxm_status status = look_begin(&l, shape, error);
  if (status == VXM_OK) {
    vxm_error local = VXM_ERROR_INIT;
    solid.count = l.window.slice_words * (size_t)(l.window.end - l.window.begin);
    solid.words = vxm_alloc(shape->context, solid.count, sizeof *solid.words, &local);
    l.window.words = solid.words;
    status = local.code;
    if (status != VXM_OK)
      vxm_error_pass(error, &local);
  }
  /* The solid by votes: asking the winding number would ask for what is being looked for. */
  const vxm_voxelize_options *asked = shape->options;
  vxm_voxelize_options votes = *asked;
  votes.method = VXM_METHOD_VOTE;
  votes.vote = VXM_VOTE_AUTO;
  shape->options = &votes;
  if (status == VXM_OK)
    status = vxm_solid_fill(&l.run, &l.window, error);
  shape->options = asked;
  const uint64_t *const voters[3] = {solid.words, solid.words, solid.words};
  if (status == VXM_OK)
    status = vxm_orient_patches_find(&shape->all_turns, &shape->facets, &l.run.placed, 0,
                                     shape->facets.split.part_count, voters, error);
  vxm_free(shape->context, solid.words);
  vxm_voxel_pass_destroy(&l.run);
  return status;
}
