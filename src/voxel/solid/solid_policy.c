/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/solid_policy.h"
#include "voxel/parity/axis_vote.h"
#include "voxel/parity/parity_union.h"
#include "voxel/parity/tetra.h"
#include "voxel/parity/vote.h"
#include "voxel/solid/orient_by_vote.h"
#include "voxel/winding/winding_fill.h"

#include <string.h>

enum { VOTERS = 4 };

static size_t kind_end(const vxm_mesh_analysis *shape, vxm_part_kind kind) {
  return shape->facets.split.kind_end[kind];
}

bool vxm_caps_wanted(const vxm_voxelize_options *options) {
  return options->method == VXM_METHOD_WINDING ||
         (options->method == VXM_METHOD_VOTE && options->vote == VXM_VOTE_AUTO);
}

bool vxm_one_voter(const vxm_voxelize_options *options) {
  return options->method != VXM_METHOD_VOTE && options->method != VXM_METHOD_WINDING;
}

size_t vxm_voted_begin(const vxm_mesh_analysis *shape) {
  /* Where no edge is odd the axes agree (voxel/parity/parity_difference.h), and there is nothing to vote on.
   */
  bool differ = shape->facets.split.odd_edge_count > 0;
  bool all = shape->options->vote_always && !vxm_caps_wanted(shape->options) && differ;
  return all ? 0 : kind_end(shape, VXM_PART_CAPPED);
}

int vxm_voxel_pass_buffers(const vxm_mesh_analysis *shape) {
  if (vxm_one_voter(shape->options) || vxm_voted_begin(shape) == shape->facets.split.part_count)
    return 0;
  if (vxm_voted_begin(shape) + 1 == shape->facets.split.part_count)
    return vxm_caps_wanted(shape->options) ? 1 : 0; /* one part: only what is contested */
  return 4;                                         /* three axes, and what is contested or the tetrahedra */
}

bool vxm_voxel_pass_apexes(const vxm_mesh_analysis *shape) {
  const vxm_voxelize_options *options = shape->options;
  bool polled = !vxm_one_voter(options) && vxm_voted_begin(shape) < shape->facets.split.part_count;
  return options->method == VXM_METHOD_TETRA || options->confidence || (polled && !vxm_caps_wanted(options));
}

vxm_status vxm_voxel_pass_buffer(vxm_voxel_pass *run, int buffer, const vxm_window *like, vxm_window *out,
                                 vxm_error *error) {
  vxm_buffer *b = &run->buffers[buffer];
  size_t count = like->slice_words * (size_t)(like->end - like->begin);
  if (count > b->count) {
    vxm_error local = VXM_ERROR_INIT;
    vxm_free(run->shape->context, b->words);
    b->words = vxm_alloc(run->shape->context, count, sizeof *b->words, &local);
    b->count = b->words ? count : 0;
    if (!b->words) {
      vxm_error_pass(error, &local);
      return local.code;
    }
  }
  *out = *like;
  out->words = b->words;
  return VXM_OK;
}

/* ---- What another engine may do ---- */

static const vxm_engine_ops *ops_of(const vxm_voxel_pass *run) {
  return run->engine ? run->engine->ops : NULL;
}

static vxm_status move_elsewhere(vxm_voxel_pass *run, const vxm_lattice *lattice, bool apexes, bool *done,
                                 vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_move_job job = {&run->shape->facets, run->motion, apexes};
  vxm_status status = vxm_snapped_points_begin(&run->placed, job.facets, lattice, error);
  if (status != VXM_OK)
    return status;
  status = ops_of(run)->move(run->engine, &run->placed, &job, done, &local);
  *done &= status == VXM_OK;
  if (status == VXM_OK || vxm_engine_falls_back(run->engine, &local))
    return VXM_OK;
  vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_voxel_pass_place(vxm_voxel_pass *run, const vxm_lattice *lattice, const double transform[12],
                                bool confidence, vxm_error *error) {
  const vxm_triangle_set *facets = &run->shape->facets;
  bool apexes = confidence || vxm_voxel_pass_apexes(run->shape) || (run->engine && run->engine->wants_apexes),
       done = false;
  if (!run->motion)
    return vxm_snapped_points_set(&run->placed, facets, lattice, transform, apexes, error);
  vxm_status status =
      ops_of(run) && ops_of(run)->move ? move_elsewhere(run, lattice, apexes, &done, error) : VXM_OK;
  return status == VXM_OK && !done
             ? vxm_snapped_points_move(&run->placed, facets, lattice, run->motion, apexes, error)
             : status;
}

static vxm_status unite(vxm_voxel_pass *run, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error) {
  if (ops_of(run) && ops_of(run)->unite)
    return ops_of(run)->unite(run->engine, window, job, error);
  return vxm_parity_union(&run->shape->workspace, window, job, error);
}

vxm_status vxm_voxel_pass_unite(vxm_voxel_pass *run, const vxm_window *window, int axis, size_t part_begin,
                                size_t part_end, unsigned roles, vxm_error *error) {
  static const char *const phase[3] = {"voxelizing along x", "voxelizing along y", "voxelizing along z"};
  vxm_parity_union_job job = {.facets = &run->shape->facets,
                              .placed = &run->placed,
                              .axis = axis,
                              .part_begin = part_begin,
                              .part_end = part_end,
                              .roles = roles,
                              .fresh = true,
                              .has_voxels = run->has_voxels,
                              .phase = phase[axis]};
  return unite(run, window, &job, error);
}

vxm_status vxm_voxel_pass_surface(vxm_voxel_pass *run, const vxm_surface *surface, const vxm_window *window,
                                  vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  const vxm_engine_ops *ops = ops_of(run);
  if (ops && ops->surface) {
    vxm_error local = VXM_ERROR_INIT;
    vxm_status status = ops->surface(run->engine, surface, window, kind, is_fresh, &local);
    if (status == VXM_OK)
      return VXM_OK;
    if (!vxm_engine_falls_back(run->engine, &local)) {
      vxm_error_pass(error, &local);
      return status;
    }
  }
  return vxm_surface_add(surface, window, kind, is_fresh, error);
}

void vxm_voxel_pass_destroy(vxm_voxel_pass *run) {
  for (int b = 0; b < VXM_BUFFERS; b++)
    vxm_free(run->shape->context, run->buffers[b].words);
  vxm_snapped_points_destroy(&run->placed);
  vxm_winding_mesh_destroy(&run->open_wound);
  vxm_winding_mesh_destroy(&run->all_wound);
}

/* ---- Parts that stay open: votes ---- */

/** The x, y, z and, if asked for, the tetrahedral voter of parts from `begin` on. */
static vxm_status fill_voters(vxm_voxel_pass *run, const vxm_window *window, size_t begin, bool tetra,
                              const uint64_t *voters[VOTERS], vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t end = run->shape->facets.split.part_count;
  for (int v = 0; v < (tetra ? VOTERS : 3) && status == VXM_OK; v++) {
    vxm_window voter;
    status = vxm_voxel_pass_buffer(run, VXM_BUFFER_VOTERS + v, window, &voter, error);
    /* Triangles and cones together are closed: any axis tells their parity. */
    unsigned roles = v == 3 ? VXM_FACET_TRIANGLE | VXM_FACET_CONE : VXM_FACET_TRIANGLE;
    if (status == VXM_OK)
      status = vxm_voxel_pass_unite(run, &voter, v == 3 ? window->layout.fast : v, begin, end, roles, error);
    voters[v] = voter.words;
  }
  return status;
}

static vxm_status settle_contested(vxm_voxel_pass *run, const vxm_window *window, const uint64_t *mask,
                                   vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  vxm_status status = VXM_OK;
  int64_t added = 0;
  if (!run->open_wound.tree) {
    status = vxm_orient_open(shape, error);
    if (status == VXM_OK)
      status = vxm_winding_mesh_create(&run->open_wound, &shape->facets, &run->placed, &shape->open_turns,
                                       run->mirrored, error);
  }
  if (status == VXM_OK)
    status =
        vxm_winding_fill(window, mask, run->open_wound.tree, shape->context, run->confidence, &added, error);
  run->added |= added > 0;
  if (added > 0 && run->has_voxels)
    for (size_t p = vxm_voted_begin(shape); p < shape->facets.split.part_count; p++)
      atomic_store_explicit(&run->has_voxels[p], 1, memory_order_relaxed);
  return status;
}

/** One part is asked about slab by slab, and the voters are never held as a whole. */
static vxm_status poll_part(vxm_voxel_pass *run, const vxm_window *window, size_t part, bool tetra,
                            vxm_vote rule, uint64_t *mask, vxm_vote_tally *tally, vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  vxm_window slice = *window, carry;
  slice.begin = 0;
  slice.end = 1;
  vxm_status status = vxm_voxel_pass_buffer(run, VXM_BUFFER_CARRY, &slice, &carry, error);
  if (status != VXM_OK)
    return status;
  if (window->begin == 0)
    memset(carry.words, 0, carry.slice_words * sizeof *carry.words);
  vxm_axis_vote_job job = {.facets = &shape->facets,
                           .placed = &run->placed,
                           .part = part,
                           .tetra = tetra,
                           .rule = rule,
                           .fresh = vxm_voted_begin(shape) == 0,
                           .mask = mask,
                           .carry = carry.words};
  return vxm_axis_vote(&shape->workspace, window, &job, tally, error);
}

/** By an engine that has votes. */
static vxm_status elect_elsewhere(vxm_voxel_pass *run, const vxm_window *window, bool tetra, vxm_vote rule,
                                  uint64_t *mask, vxm_vote_tally *tally, vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  vxm_vote_job job = {.facets = &shape->facets,
                      .placed = &run->placed,
                      .part_begin = vxm_voted_begin(shape),
                      .part_end = shape->facets.split.part_count,
                      .tetra = tetra,
                      .rule = rule,
                      .mask = mask,
                      .has_voxels = run->has_voxels};
  return ops_of(run)->elect(run->engine, window, &job, tally, error);
}

static vxm_status decide_open_parts(vxm_voxel_pass *run, const vxm_window *window, vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  size_t begin = vxm_voted_begin(shape), end = shape->facets.split.part_count;
  if (begin == end)
    return VXM_OK;
  bool decide = vxm_caps_wanted(shape->options), tetra = !decide;
  vxm_vote rule = decide ? VXM_VOTE_AUTO : shape->options->vote;
  vxm_window mask = {.words = NULL};
  vxm_vote_tally tally = {0, false};
  vxm_status status = decide ? vxm_voxel_pass_buffer(run, VXM_BUFFER_MASK, window, &mask, error) : VXM_OK;
  if (status == VXM_OK && ops_of(run) && ops_of(run)->elect)
    status = elect_elsewhere(run, window, tetra, rule, mask.words, &tally, error);
  else if (status == VXM_OK && end - begin == 1 && !run->no_poll) {
    status = poll_part(run, window, begin, tetra, rule, mask.words, &tally, error);
    if (tally.added && run->has_voxels)
      atomic_store_explicit(&run->has_voxels[begin], 1, memory_order_relaxed);
  } else if (status == VXM_OK) {
    const uint64_t *voters[VOTERS] = {NULL};
    status = fill_voters(run, window, begin, tetra, voters, error);
    if (status == VXM_OK)
      vxm_vote_count(window->words, voters, mask.words,
                     window->slice_words * (size_t)(window->end - window->begin), rule, shape->context,
                     &tally);
  }
  if (status != VXM_OK)
    return status;
  run->contested += tally.contested;
  run->added |= tally.added;
  if (!decide || tally.contested == 0 || shape->options->method == VXM_METHOD_WINDING)
    return VXM_OK; /* the winding number is asked about every voxel anyway */
  run->escalated += tally.contested;
  return settle_contested(run, window, mask.words, error);
}

/* ---- Methods ---- */

/** Every voxel by the winding number. */
static vxm_status fill_by_winding(vxm_voxel_pass *run, const vxm_window *window, vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  vxm_status status = VXM_OK;
  if (!run->all_wound.tree) {
    status = vxm_orient_all(shape, error);
    if (status == VXM_OK)
      status = vxm_winding_mesh_create(&run->all_wound, &shape->facets, &run->placed, &shape->all_turns,
                                       run->mirrored, error);
  }
  if (status != VXM_OK)
    return status;
  size_t depth = (size_t)(window->end - window->begin);
  memset(window->words, 0, depth * window->slice_words * sizeof *window->words);
  int64_t added = 0;
  run->escalated += window->fast_dim * window->middle_dim * (int64_t)depth;
  status =
      vxm_winding_fill(window, NULL, run->all_wound.tree, shape->context, run->confidence, &added, error);
  run->added |= added > 0;
  return status;
}

static vxm_status fill_by_one(vxm_voxel_pass *run, const vxm_window *window, vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  size_t end = shape->facets.split.part_count;
  vxm_method method = shape->options->method;
  if (method != VXM_METHOD_TETRA)
    return vxm_voxel_pass_unite(run, window, (int)method - VXM_METHOD_X, 0, end, VXM_FACET_TRIANGLE, error);
  vxm_parity_union_job job = {.facets = &shape->facets,
                              .placed = &run->placed,
                              .part_end = end,
                              .fresh = true,
                              .has_voxels = run->has_voxels,
                              .phase = "voxelizing tetrahedra"};
  if (ops_of(run) && ops_of(run)->unite) { /* parity with cones has the same bits */
    job.axis = window->layout.fast;
    job.roles = VXM_FACET_TRIANGLE | VXM_FACET_CONE;
    return unite(run, window, &job, error);
  }
  return vxm_tetra_unite(&shape->workspace, window, &job, error);
}

static vxm_status fill(vxm_voxel_pass *run, const vxm_window *window, vxm_error *error) {
  vxm_mesh_analysis *shape = run->shape;
  if (vxm_one_voter(shape->options))
    return fill_by_one(run, window, error);
  /* Parts that are closed, or closed by caps: one axis settles them. Without any, a poll starts afresh. */
  vxm_status status = VXM_OK;
  if (vxm_voted_begin(shape) > 0 || shape->facets.split.part_count != 1 || ops_of(run) || run->no_poll)
    status = vxm_voxel_pass_unite(run, window, window->layout.fast, 0, vxm_voted_begin(shape),
                                  VXM_FACET_TRIANGLE | VXM_FACET_CAP, error);
  if (status == VXM_OK)
    status = decide_open_parts(run, window, error);
  if (status == VXM_OK && shape->options->method == VXM_METHOD_WINDING)
    status = fill_by_winding(run, window, error);
  return status;
}

vxm_status vxm_solid_fill(vxm_voxel_pass *run, const vxm_window *window, vxm_error *error) {
  int64_t contested = run->contested, escalated = run->escalated;
  bool added = run->added;
  vxm_error local = VXM_ERROR_INIT;
  bool elsewhere = ops_of(run) != NULL;
  run->no_poll &= window->begin > 0;
  vxm_status status = fill(run, window, &local);
  if (status != VXM_OK && elsewhere && vxm_engine_falls_back(run->engine, &local)) {
    run->contested = contested;
    run->escalated = escalated;
    run->added = added;
    run->no_poll = window->begin > 0;
    status = fill(run, window, &local);
  }
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
