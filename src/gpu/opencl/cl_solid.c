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

vxm_status vxm_cl_each_slab(vxm_engine *base, const vxm_window *window, bool is_or, vxm_slab_fn make,
                            void *payload, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_cl_return back[2] = {{.from = VXM_CL_RESULT}, {.from = VXM_CL_RESULT2}};
  int64_t slices = 1;
  int which = 0;
  vxm_status status = vxm_cl_slab_slices(&slices, engine, window, error);
  for (int64_t k = window->begin; k < window->end && status == VXM_OK; k += slices, which ^= 1) {
    vxm_slab slab = vxm_slab_of(window, k, slices);
    status = vxm_cl_return_end(engine, &back[which], status, error);
    vxm_progress_part before = vxm_slab_progress(&slab);
    if (status == VXM_OK)
      status = make(base, &slab, (int)back[which].from, payload, error);
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

/** Into none where tiles of columns are the better way. */
static vxm_status divide(vxm_disjoint_passes *passes, vxm_engine *base, const vxm_window *window,
                         const vxm_parity_union_job *job, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_cl_method method = vxm_cl_can_tile(engine, window, job) ? engine->options.cl_method : VXM_CL_TRIANGLES;
  bool is_better = engine->base.info.hardware || window->fast_dim >= LONG_COLUMN;
  if (method == VXM_CL_TILES || (method == VXM_CL_AUTO && is_better))
    return VXM_OK;
  return vxm_device_cache_passes(passes, &engine->device_cache, window, job, 0,
                                 method == VXM_CL_AUTO ? PASSES_MOST : SIZE_MAX, error);
}

/** By `passes`, or by tiles of columns where there are none. */
static vxm_status unite(vxm_engine *base, const vxm_slab *slab, const vxm_parity_union_job *job,
                        vxm_disjoint_passes *passes, int to, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  const vxm_cl_buffer_id into = (vxm_cl_buffer_id)to;
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

static vxm_status bring(vxm_engine *base, const vxm_slab *slab, int into, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  return base->keeps ? vxm_cl_slab_bring(engine, slab, (vxm_cl_buffer_id)into, error)
                     : vxm_cl_slab_upload(engine, (vxm_cl_buffer_id)into, slab, error);
}

static vxm_status count_votes(vxm_engine *base, const vxm_slab *slab, const int voters[VXM_VOTERS],
                              uint32_t rule, int result, uint32_t counted[2], vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  const size_t bytes = 2 * sizeof *counted;
  const cl_uint count = (cl_uint)(2 * slab->words);
  vxm_status status = vxm_cl_clear(engine, VXM_CL_TALLY, bytes, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_VOTE, count,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, voters[0]), VXM_CL_MEM(engine, voters[1]),
                                    VXM_CL_MEM(engine, voters[2]), VXM_CL_MEM(engine, voters[3]),
                                    VXM_CL_MEM(engine, result), VXM_CL_MEM(engine, VXM_CL_TALLY),
                                    VXM_CL_VALUE(count), VXM_CL_VALUE(rule)),
                        error);
  return status == VXM_OK ? vxm_cl_download(engine, VXM_CL_TALLY, 0, counted, bytes, error) : status;
}

static vxm_status clear_touched(vxm_engine *base, size_t part_count, vxm_error *error) {
  return vxm_cl_clear(vxm_opencl_of(base), VXM_CL_TOUCHED, part_count * sizeof(uint32_t), error);
}

static vxm_status read_touched(vxm_engine *base, uint32_t *out, size_t part_count, vxm_error *error) {
  return vxm_cl_download(vxm_opencl_of(base), VXM_CL_TOUCHED, 0, out, part_count * sizeof *out, error);
}

const vxm_slab_solid vxm_cl_slab_solid = {.voter_x = VXM_CL_VOTER_X,
                                          .each_slab = vxm_cl_each_slab,
                                          .divide = divide,
                                          .unite = unite,
                                          .bring = bring,
                                          .count_votes = count_votes,
                                          .clear_touched = clear_touched,
                                          .read_touched = read_touched};

vxm_status vxm_cl_unite(vxm_engine *base, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error) {
  return vxm_slab_solid_unite(&vxm_cl_slab_solid, &vxm_opencl_of(base)->device_cache, window, job, error);
}

vxm_status vxm_cl_vote(vxm_engine *base, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error) {
  return vxm_slab_solid_vote(&vxm_cl_slab_solid, &vxm_opencl_of(base)->device_cache, window, job, tally,
                             error);
}
