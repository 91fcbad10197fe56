/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/solid_votes.h"
#include "base/threads.h"
#include "voxel/parity/axis_vote.h"
#include "voxel/parity/odd_lines.h"
#include "voxel/solid/orient_open.h"
#include "voxel/winding/winding_fill.h"

#include <string.h>

enum { VOTERS = 4 };

/** The x, y, z and, if asked for, the tetrahedral voter of parts from `begin` on. */
static vxm_status fill_voters(vxm_voxel_pass *pass, const vxm_window *window, size_t begin, bool tetra,
                              uint64_t *voters[VOTERS], vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t end = pass->analysis->triangles.split.part_count;
  for (int v = 0; v < (tetra ? VOTERS : 3) && status == VXM_OK; v++) {
    vxm_window voter;
    status = vxm_voxel_pass_buffer(pass, VXM_BUFFER_VOTERS + v, window, &voter, error);
    /* Triangles and cones together are closed: any axis tells their parity. */
    unsigned roles = v == 3 ? VXM_ROLE_FACE | VXM_ROLE_CONE : VXM_ROLE_FACE;
    if (status == VXM_OK)
      status = vxm_voxel_pass_unite(pass, &voter, v == 3 ? window->layout.fast : v, begin, end, roles, error);
    voters[v] = voter.words;
  }
  return status;
}

/** The slices from the first to the last one in which something is asked about; `mask` becomes theirs. */
static vxm_window asked_slices(const vxm_window *window, const uint64_t **mask) {
  vxm_window part = *window;
  const size_t slice = window->slice_words;
  for (; part.begin < part.end && vxm_words_are_zero(*mask, slice); part.begin++) {
    part.words += slice;
    *mask += slice;
  }
  while (part.begin < part.end &&
         vxm_words_are_zero(*mask + (size_t)(part.end - part.begin - 1) * slice, slice))
    part.end--;
  return part;
}

static vxm_status settle_contested(vxm_voxel_pass *pass, const vxm_window *window, const uint64_t *mask,
                                   vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  vxm_status status = VXM_OK;
  bool added = false;
  if (!pass->open_winding.chain) {
    const vxm_winding_chain *chain;
    status = vxm_orient_open(&chain, analysis, pass->workspace, error);
    if (status == VXM_OK)
      status = vxm_winding_mesh_place(&pass->open_winding, chain, &pass->placed, window->layout.fast,
                                      pass->mirrored, error);
  }
  vxm_window part = pass->confidence ? *window : asked_slices(window, &mask); /* or all of the grid */
  if (status == VXM_OK)
    status =
        vxm_winding_fill(&pass->open_winding, &part, mask, pass->confidence, pass->workspace, &added, error);
  pass->added |= added;
  if (added && pass->has_voxels)
    for (size_t p = vxm_voted_begin(analysis, &pass->options); p < analysis->triangles.split.part_count; p++)
      atomic_store_explicit(&pass->has_voxels[p], 1, memory_order_relaxed);
  return status;
}

/** One part is asked about slab by slab, and the voters are never held as a whole. */
static vxm_status poll_part(vxm_voxel_pass *pass, const vxm_window *window, size_t part, bool tetra,
                            vxm_vote rule, uint64_t *mask, vxm_vote_tally *tally, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  vxm_window slice = *window, carry;
  slice.begin = 0;
  slice.end = 1;
  vxm_status status = vxm_voxel_pass_buffer(pass, VXM_BUFFER_CARRY, &slice, &carry, error);
  if (status != VXM_OK)
    return status;
  if (window->begin == 0)
    memset(carry.words, 0, carry.slice_words * sizeof *carry.words);
  vxm_axis_vote_job job = {.triangles = &analysis->triangles,
                           .placed = &pass->placed,
                           .part = part,
                           .tetra = tetra,
                           .rule = rule,
                           .fresh = vxm_voted_begin(analysis, &pass->options) == 0,
                           .mask = mask,
                           .carry = carry.words};
  return vxm_axis_vote(pass->workspace, window, &job, tally, error);
}

typedef struct abstention {
  const vxm_odd_lines *lines;
  uint64_t *voters[3]; /**< fast, middle, slow */
} abstention;

static void abstain_in_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const abstention *job = payload;
  size_t at = slice * job->lines->window.slice_words;
  if (vxm_odd_lines_in(job->lines, slice))
    vxm_odd_lines_abstain(job->lines, slice,
                          (uint64_t *[]){job->voters[0] + at, job->voters[1] + at, job->voters[2] + at});
}

vxm_status vxm_solid_leave_out_abstainers(vxm_voxel_pass *pass, const vxm_window *window, size_t part_begin,
                                          size_t part_end, uint64_t *const voters[3], vxm_error *error) {
  const vxm_layout layout = window->layout;
  vxm_odd_lines lines;
  abstention job = {&lines, {voters[layout.fast], voters[layout.middle], voters[layout.slow]}};
  vxm_status status = vxm_odd_lines_find(&lines, pass->context, window, &pass->placed,
                                         &pass->analysis->triangles, part_begin, part_end, error);
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(pass->context, (size_t)(window->end - window->begin), abstain_in_slice,
                                      &job, error);
  vxm_odd_lines_destroy(&lines);
  return status;
}

/** The voters are made as a whole, by an engine if there is one. */
static vxm_status count_votes(vxm_voxel_pass *pass, const vxm_window *window, bool tetra, vxm_vote rule,
                              uint64_t *mask, vxm_vote_tally *tally, vxm_error *error) {
  size_t begin = vxm_voted_begin(pass->analysis, &pass->options),
         end = pass->analysis->triangles.split.part_count;
  uint64_t *voters[VOTERS] = {NULL};
  atomic_uchar *has_voxels = pass->has_voxels;
  if (end - begin == 1)
    pass->has_voxels = NULL; /* what is elected tells that */
  vxm_status status = fill_voters(pass, window, begin, tetra, voters, error);
  pass->has_voxels = has_voxels;
  if (status == VXM_OK && rule == VXM_VOTE_AUTO)
    status = vxm_solid_leave_out_abstainers(pass, window, begin, end, voters, error);
  if (status == VXM_OK)
    vxm_vote_count(window->words, (const uint64_t *const *)voters, mask,
                   window->slice_words * (size_t)(window->end - window->begin), rule, pass->context, tally);
  return status;
}

/** By the rules that need nothing but the voters, by an engine that has votes. */
static vxm_status elect_elsewhere(vxm_voxel_pass *pass, const vxm_window *window, bool tetra, vxm_vote rule,
                                  vxm_vote_tally *tally, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  vxm_vote_job job = {.triangles = &analysis->triangles,
                      .placed = &pass->placed,
                      .part_begin = vxm_voted_begin(analysis, &pass->options),
                      .part_end = analysis->triangles.split.part_count,
                      .tetra = tetra,
                      .rule = rule,
                      .has_voxels = pass->has_voxels};
  return vxm_voxel_pass_ops(pass)->vote(pass->engine, window, &job, tally, error);
}

static vxm_status decide_open_parts(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  size_t begin = vxm_voted_begin(analysis, &pass->options), end = analysis->triangles.split.part_count;
  if (begin == end)
    return VXM_OK;
  bool decide = vxm_caps_wanted(&pass->options), tetra = !decide;
  vxm_vote rule = decide ? VXM_VOTE_AUTO : pass->options.vote;
  vxm_window mask = {.words = NULL};
  vxm_vote_tally tally = {0, false};
  vxm_status status = decide ? vxm_voxel_pass_buffer(pass, VXM_BUFFER_MASK, window, &mask, error) : VXM_OK;
  if (status == VXM_OK && !decide && vxm_voxel_pass_ops(pass) && vxm_voxel_pass_ops(pass)->vote)
    status = elect_elsewhere(pass, window, tetra, rule, &tally, error);
  else if (status == VXM_OK && end - begin == 1 && !vxm_voxel_pass_ops(pass) && !pass->no_vote_resume)
    status = poll_part(pass, window, begin, tetra, rule, mask.words, &tally, error);
  else if (status == VXM_OK)
    status = count_votes(pass, window, tetra, rule, mask.words, &tally, error);
  if (end - begin == 1 && tally.added && pass->has_voxels)
    atomic_store_explicit(&pass->has_voxels[begin], 1, memory_order_relaxed);
  if (status != VXM_OK)
    return status;
  pass->contested += tally.contested;
  pass->added |= tally.added;
  if (!decide || tally.contested == 0 || pass->options.method == VXM_METHOD_WINDING)
    return VXM_OK; /* the winding number is asked about every voxel anyway */
  pass->winding_decided += tally.contested;
  return settle_contested(pass, window, mask.words, error);
}

vxm_status vxm_solid_vote(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  size_t begin = vxm_voted_begin(analysis, &pass->options);
  /* Parts that are closed, or closed by caps: one axis settles them. Without any, a poll starts afresh. */
  vxm_status status = VXM_OK;
  if (begin > 0 || analysis->triangles.split.part_count != 1 || vxm_voxel_pass_ops(pass) ||
      pass->no_vote_resume)
    status = vxm_voxel_pass_unite(pass, window, window->layout.fast, 0, begin, VXM_ROLE_FACE | VXM_ROLE_CAP,
                                  error);
  return status == VXM_OK ? decide_open_parts(pass, window, error) : status;
}
