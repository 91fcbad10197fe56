/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids by OpenCL: slabs are made one after another, and each is taken back while the next is made. */
#include "gpu/opencl/cl_solid.h"

#include <string.h>

/** What devices in software do triangle by triangle, unless that is asked for; GPUs are faster by tiles of
 * columns always (doc/engines.md has the times). */
enum {
  PASSES_MOST = 4,   /**< so few passes */
  LONG_COLUMN = 1024 /**< columns of fewer voxels */
};

static vxm_status clear_touched(vxm_opencl *engine, const vxm_triangle_set *triangles, vxm_error *error) {
  return vxm_cl_clear(engine, VXM_CL_TOUCHED, triangles->split.part_count * sizeof(uint32_t), error);
}

vxm_status vxm_cl_touched_take(vxm_opencl *engine, atomic_uchar *has_voxels,
                               const vxm_triangle_set *triangles, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t parts = triangles->split.part_count;
  uint32_t *set = vxm_alloc(engine->base.context, parts, sizeof *set, &local);
  vxm_status status =
      set ? vxm_cl_download(engine, VXM_CL_TOUCHED, 0, set, parts * sizeof *set, &local) : local.code;
  for (size_t p = 0; p < parts && status == VXM_OK; p++)
    if (set[p] == 1)
      atomic_store_explicit(&has_voxels[p], 1, memory_order_relaxed);
  vxm_free(engine->base.context, set);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Ends what is under way; after a failure, when flips may be left over and something may still run, too.
 * Returns `status`, or the first failure. */
static vxm_status finish(vxm_opencl *engine, vxm_cl_return back[2], vxm_status status, vxm_error *error) {
  for (int i = 0; i < 2; i++)
    status = vxm_cl_return_end(engine, &back[i], status, error);
  if (status != VXM_OK) {
    engine->cl->Finish(engine->queue);
    engine->cl->Finish(engine->transfer);
    vxm_cl_release(engine, VXM_CL_FLIPS);
  }
  return status;
}

vxm_status vxm_cl_each_slab(vxm_opencl *engine, const vxm_window *window, bool is_or, vxm_cl_slab_fn make,
                            void *payload, vxm_error *error) {
  vxm_cl_return back[2] = {{.from = VXM_CL_RESULT}, {.from = VXM_CL_RESULT2}};
  int64_t slices = 1;
  int which = 0;
  vxm_status status = vxm_cl_slab_slices(&slices, engine, window, error);
  for (int64_t k = window->begin; k < window->end && status == VXM_OK; k += slices, which ^= 1) {
    vxm_slab slab = vxm_slab_of(window, k, slices);
    status = vxm_cl_return_end(engine, &back[which], status, error);
    vxm_progress_part before = vxm_slab_progress(&slab);
    if (status == VXM_OK)
      status = make(engine, &slab, back[which].from, payload, error);
    vxm_progress_leave(before);
    back[which].slab = slab;
    back[which].is_or = is_or;
    if (status == VXM_OK && engine->base.keeps)
      status = vxm_cl_slab_stay(engine, &slab, back[which].from, error);
    else if (status == VXM_OK)
      status = vxm_cl_return_begin(engine, &back[which], error);
  }
  return finish(engine, back, status, error);
}

/* ---- Unions ---- */

/** Divides the parts into passes, or into none where tiles of columns are the better way. */
static vxm_status choose(vxm_opencl *engine, const vxm_window *window, const vxm_parity_union_job *job,
                         vxm_disjoint_passes *passes, vxm_error *error) {
  vxm_cl_method method = vxm_cl_can_tile(engine, window, job) ? engine->options.cl_method : VXM_CL_TRIANGLES;
  bool is_better = engine->base.info.hardware || window->fast_dim >= LONG_COLUMN;
  if (method == VXM_CL_TILES || (method == VXM_CL_AUTO && is_better))
    return VXM_OK;
  return vxm_device_cache_passes(passes, &engine->device_cache, window, job, 0,
                                 method == VXM_CL_AUTO ? PASSES_MOST : SIZE_MAX, error);
}

/** Makes the words of a slab: by `passes`, or by tiles of columns where there are none. */
static vxm_status make_slab(vxm_opencl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                            vxm_disjoint_passes *passes, vxm_cl_buffer_id into, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = VXM_OK;
  if (passes->count == 0) {
    status = vxm_cl_tiles(engine, slab, job, into, &local);
    if (status == VXM_OK)
      return VXM_OK;
    if (status != VXM_ERROR_RANGE || engine->options.cl_method == VXM_CL_TILES) {
      vxm_error_pass(error, &local);
      return status;
    }
    vxm_disjoint_passes_destroy(
        passes); /* the lists of tiles are too long: what nobody asked for is left again */
    status = vxm_device_cache_passes(passes, &engine->device_cache, slab->window, job, 0, SIZE_MAX, error);
  }
  return status == VXM_OK ? vxm_cl_columns(engine, slab, job, passes, into, error) : status;
}

typedef struct union_job {
  const vxm_parity_union_job *job;
  vxm_disjoint_passes *passes;
} union_job;

static vxm_status unite_slab(vxm_opencl *engine, const vxm_slab *slab, vxm_cl_buffer_id into, void *payload,
                             vxm_error *error) {
  const union_job *u = payload;
  return make_slab(engine, slab, u->job, u->passes, into, error);
}

vxm_status vxm_cl_unite(vxm_engine *base, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_disjoint_passes passes = {.context = base->context};
  if (base->keeps && !job->fresh)
    return vxm_fail_to_keep(base, error);
  if (job->part_begin >= job->part_end) {
    if (job->fresh && !base->keeps) /* what stays began as zeros */
      vxm_window_clear(window, window->begin, window->end);
    return VXM_OK;
  }
  vxm_status status = vxm_device_cache_triangles(&engine->device_cache, job->triangles, job->placed, error);
  if (status == VXM_OK)
    status = choose(engine, window, job, &passes, error);
  if (status == VXM_OK && job->has_voxels)
    status = clear_touched(engine, job->triangles, error);
  if (status == VXM_OK)
    status = vxm_cl_each_slab(engine, window, !job->fresh, unite_slab, &(union_job){job, &passes}, error);
  if (status == VXM_OK && job->has_voxels)
    status = vxm_cl_touched_take(engine, job->has_voxels, job->triangles, error);
  vxm_disjoint_passes_destroy(&passes);
  return status;
}

/* ---- Votes ---- */

/** The voters of an election: how many are united, and where the words of each are. */
typedef struct voter_set {
  const vxm_vote_job *job;
  vxm_cl_buffer_id words[VXM_VOTERS];
  int count;
} voter_set;

/** The tetrahedra, if not asked, vote as x does. */
static voter_set voters_of(const vxm_vote_job *job) {
  voter_set b = {.job = job, .count = job->tetra ? VXM_VOTERS : VXM_VOTERS - 1};
  for (int v = 0; v < VXM_VOTERS; v++)
    b.words[v] = (vxm_cl_buffer_id)(v < b.count ? VXM_CL_VOTER_X + v : VXM_CL_VOTER_X);
  return b;
}

/** Makes the words of one voter. The lists of all voters share their buffers, so that each is divided anew.
 */
static vxm_status make_voter(vxm_opencl *engine, const vxm_slab *slab, const voter_set *b, int v,
                             vxm_error *error) {
  vxm_parity_union_job job = vxm_voter(b->job, slab->window, v);
  vxm_disjoint_passes passes = {.context = engine->base.context};
  vxm_progress_part before = vxm_progress_enter((double)v / b->count, (v + 1.0) / b->count);
  vxm_status status = choose(engine, slab->window, &job, &passes, error);
  if (status == VXM_OK)
    status = make_slab(engine, slab, &job, &passes, b->words[v], error);
  vxm_disjoint_passes_destroy(&passes);
  vxm_progress_leave(before);
  return status;
}

static vxm_status count_votes(vxm_opencl *engine, const vxm_slab *slab, const voter_set *b, vxm_vote rule,
                              vxm_cl_buffer_id result, vxm_error *error) {
  const cl_uint count = (cl_uint)(2 * slab->words);
  const cl_uint number = rule == VXM_VOTE_MAJORITY ? 1 : rule == VXM_VOTE_ANY ? 2 : 0;
  return vxm_cl_run(engine, VXM_CL_VOTE, count,
                    VXM_CL_ARGS(VXM_CL_MEM(engine, b->words[0]), VXM_CL_MEM(engine, b->words[1]),
                                VXM_CL_MEM(engine, b->words[2]), VXM_CL_MEM(engine, b->words[3]),
                                VXM_CL_MEM(engine, result), VXM_CL_MEM(engine, VXM_CL_TALLY),
                                VXM_CL_VALUE(count), VXM_CL_VALUE(number)),
                    error);
}

typedef struct election {
  const vxm_vote_job *job;
  voter_set voters;
  vxm_vote_tally *tally;
} election;

static vxm_status elect_slab(vxm_opencl *engine, const vxm_slab *slab, vxm_cl_buffer_id result, void *payload,
                             vxm_error *error) {
  const election *e = payload;
  uint32_t counted[2] = {0, 0};
  vxm_status status = engine->base.keeps ? vxm_cl_slab_bring(engine, slab, result, error)
                                         : vxm_cl_slab_upload(engine, result, slab, error);
  for (int v = 0; v < e->voters.count && status == VXM_OK; v++)
    status = make_voter(engine, slab, &e->voters, v, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_TALLY, sizeof counted, error);
  if (status == VXM_OK)
    status = count_votes(engine, slab, &e->voters, e->job->rule, result, error);
  if (status == VXM_OK)
    status = vxm_cl_download(engine, VXM_CL_TALLY, 0, counted, sizeof counted, error);
  e->tally->contested += counted[0];
  e->tally->added |= counted[1] != 0;
  return status;
}

vxm_status vxm_cl_vote(vxm_engine *base, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  if (job->part_begin >= job->part_end)
    return VXM_OK;
  vxm_status status = vxm_device_cache_triangles(&engine->device_cache, job->triangles, job->placed, error);
  if (status == VXM_OK && job->has_voxels)
    status = clear_touched(engine, job->triangles, error);
  election e = {job, voters_of(job), tally};
  if (status == VXM_OK)
    status = vxm_cl_each_slab(engine, window, false, elect_slab, &e, error);
  if (status == VXM_OK && job->has_voxels)
    status = vxm_cl_touched_take(engine, job->has_voxels, job->triangles, error);
  return status;
}
