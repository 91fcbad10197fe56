/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/slab_solid.h"

vxm_status vxm_slab_solid_touched(const vxm_slab_solid *solid, vxm_engine *engine, atomic_uchar *has_voxels,
                                  size_t part_count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *marks = vxm_alloc(engine->context, part_count, sizeof *marks, &local);
  vxm_status status = marks ? solid->read_touched(engine, marks, part_count, &local) : local.code;
  for (size_t p = 0; p < part_count && status == VXM_OK; p++)
    if (marks[p] == 1)
      atomic_store_explicit(&has_voxels[p], 1, memory_order_relaxed);
  vxm_free(engine->context, marks);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Makes all slabs of a window, and tells which parts set a voxel unless `has_voxels` is NULL. */
static vxm_status make_all(const vxm_slab_solid *solid, vxm_engine *engine, const vxm_window *window,
                           bool is_or, vxm_slab_fn make, void *payload, atomic_uchar *has_voxels,
                           size_t part_count, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (has_voxels)
    status = solid->clear_touched(engine, part_count, error);
  if (status == VXM_OK)
    status = solid->each_slab(engine, window, is_or, make, payload, error);
  if (status == VXM_OK && has_voxels)
    status = vxm_slab_solid_touched(solid, engine, has_voxels, part_count, error);
  return status;
}

/* ---- Unions ---- */

typedef struct union_work {
  const vxm_slab_solid *solid;
  const vxm_parity_union_job *job;
  vxm_disjoint_passes passes;
} union_work;

static vxm_status unite_slab(vxm_engine *engine, const vxm_slab *slab, int into, void *payload,
                             vxm_error *error) {
  union_work *work = payload;
  return work->solid->unite(engine, slab, work->job, &work->passes, into, error);
}

vxm_status vxm_slab_solid_unite(const vxm_slab_solid *solid, vxm_device_cache *cache,
                                const vxm_window *window, const vxm_parity_union_job *job, vxm_error *error) {
  vxm_engine *engine = cache->engine;
  union_work work = {solid, job, {.context = engine->context}};
  if (engine->keeps && !job->fresh)
    return vxm_fail_to_keep(engine, error);
  if (job->part_begin >= job->part_end) {
    if (job->fresh && !engine->keeps) /* what stays began as zeros */
      vxm_window_clear(window, window->begin, window->end);
    return VXM_OK;
  }
  vxm_status status = vxm_device_cache_triangles(cache, job->triangles, job->placed, error);
  if (status == VXM_OK)
    status = solid->divide(&work.passes, engine, window, job, error);
  if (status == VXM_OK)
    status = make_all(solid, engine, window, !job->fresh, unite_slab, &work, job->has_voxels,
                      job->triangles->split.part_count, error);
  vxm_disjoint_passes_destroy(&work.passes);
  return status;
}

/* ---- Votes ---- */

typedef struct election {
  const vxm_slab_solid *solid;
  const vxm_vote_job *job;
  vxm_vote_tally *tally;
} election;

/** Makes the words of one voter of some. The lists of all voters share their buffers, so that each is divided
 * anew. */
static vxm_status make_voter(vxm_engine *engine, const vxm_slab *slab, const election *e, int voter,
                             int voters, vxm_error *error) {
  vxm_parity_union_job job = vxm_voter(e->job, slab->window, voter);
  vxm_disjoint_passes passes = {.context = engine->context};
  vxm_progress_part before = vxm_progress_enter((double)voter / voters, (voter + 1.0) / voters);
  vxm_status status = e->solid->divide(&passes, engine, slab->window, &job, error);
  if (status == VXM_OK)
    status = e->solid->unite(engine, slab, &job, &passes, e->solid->voter_x + voter, error);
  vxm_disjoint_passes_destroy(&passes);
  vxm_progress_leave(before);
  return status;
}

static vxm_status elect_slab(vxm_engine *engine, const vxm_slab *slab, int into, void *payload,
                             vxm_error *error) {
  const election *e = payload;
  const vxm_vote rule = e->job->rule;
  const int count = e->job->tetra ? VXM_VOTERS : VXM_VOTERS - 1;
  int voters[VXM_VOTERS];
  uint32_t counted[2] = {0, 0};
  for (int v = 0; v < VXM_VOTERS; v++) /* the tetrahedra, if not asked, vote as x does */
    voters[v] = e->solid->voter_x + (v < count ? v : 0);
  vxm_status status = e->solid->bring(engine, slab, into, error);
  for (int v = 0; v < count && status == VXM_OK; v++)
    status = make_voter(engine, slab, e, v, count, error);
  if (status == VXM_OK)
    status = e->solid->count_votes(engine, slab, voters,
                                   rule == VXM_VOTE_MAJORITY ? 1 : (rule == VXM_VOTE_ANY ? 2 : 0), into,
                                   counted, error);
  e->tally->contested += counted[0];
  e->tally->added |= counted[1] != 0;
  return status;
}

vxm_status vxm_slab_solid_vote(const vxm_slab_solid *solid, vxm_device_cache *cache, const vxm_window *window,
                               const vxm_vote_job *job, vxm_vote_tally *tally, vxm_error *error) {
  if (job->part_begin >= job->part_end)
    return VXM_OK;
  vxm_status status = vxm_device_cache_triangles(cache, job->triangles, job->placed, error);
  if (status == VXM_OK)
    status = make_all(solid, cache->engine, window, false, elect_slab, &(election){solid, job, tally},
                      job->has_voxels, job->triangles->split.part_count, error);
  return status;
}
