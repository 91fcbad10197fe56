/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids by OpenGL: slabs are drawn one after another, and each is taken back while the next is drawn. */
#include "gpu/opengl/gl_solid.h"

#include <string.h>

/** Ends what is under way, after a failure too: a driver may not lose a buffer that it writes. Returns
 * `status`, or the first failure. */
static vxm_status finish(vxm_opengl *engine, vxm_gl_return back[2], vxm_status status, vxm_error *error) {
  for (int i = 0; i < 2; i++) {
    vxm_status ended = vxm_gl_return_end(engine, &back[i], status == VXM_OK ? error : NULL);
    status = status == VXM_OK ? ended : status;
  }
  if (status != VXM_OK) /* flips may be left in it */
    vxm_gl_release(engine, VXM_GL_FLIPS);
  return status;
}

vxm_status vxm_gl_each_slab(vxm_opengl *engine, const vxm_window *window, bool is_or, vxm_gl_slab_fn make,
                            void *payload, vxm_error *error) {
  vxm_gl_return back[2] = {{.staging = 0}, {.staging = 1}};
  int64_t slices = 1;
  int which = 0;
  vxm_status status = vxm_gl_slab_slices(&slices, engine, window, error);
  for (int64_t k = window->begin; k < window->end && status == VXM_OK; k += slices, which ^= 1) {
    vxm_slab slab = vxm_slab_of(window, k, slices);
    vxm_progress_part before = vxm_slab_progress(&slab);
    status = make(engine, &slab, payload, error);
    vxm_progress_leave(before);
    if (status != VXM_OK)
      break;
    if (engine->base.keeps) {
      status = vxm_gl_slab_stay(engine, &slab, error);
      continue;
    }
    back[which] = (vxm_gl_return){.slab = slab, .is_or = is_or, .staging = which};
    status = vxm_gl_return_begin(engine, &back[which], error);
    if (status == VXM_OK)
      status = vxm_gl_return_end(engine, &back[which ^ 1], error);
  }
  return finish(engine, back, status, error);
}

/** By the method that was chosen; parts that stay open have no tetrahedra to speak of, and go by columns. */
static vxm_status make_slab(vxm_opengl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                            const vxm_disjoint_passes *passes, vxm_gl_buffer_id into, vxm_error *error) {
  bool slices = engine->options.gl_method != VXM_GL_COLUMNS && vxm_gl_can_slice(job);
  return (slices ? vxm_gl_slices : vxm_gl_columns)(engine, slab, job, passes, into, error);
}

static vxm_status create_passes(vxm_disjoint_passes *out, vxm_opengl *engine, const vxm_window *window,
                                const vxm_parity_union_job *job, vxm_error *error) {
  /* Slices move points, and the apex in any case a little. */
  double move = engine->options.displacement;
  int64_t margin = engine->base.wants_apexes ? (int64_t)(move < 1 << 20 ? move : 1 << 20) + 1 : 0;
  return vxm_device_cache_passes(out, &engine->device_cache, window, job, margin, SIZE_MAX, error);
}

static vxm_status clear_touched(vxm_opengl *engine, size_t part_count, vxm_error *error) {
  vxm_status status = vxm_gl_reserve(engine, VXM_GL_TOUCHED, part_count * sizeof(uint32_t), error);
  if (status != VXM_OK)
    return status;
  const vxm_gl *gl = &engine->context.gl;
  gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[VXM_GL_TOUCHED].name);
  gl->ClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
  return VXM_OK;
}

static vxm_status take_touched(vxm_opengl *engine, atomic_uchar *has_voxels, size_t part_count,
                               vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *set = vxm_alloc(engine->base.context, part_count, sizeof *set, &local);
  vxm_status status =
      set ? vxm_gl_download(engine, VXM_GL_TOUCHED, set, part_count * sizeof *set, &local) : local.code;
  for (size_t p = 0; p < part_count && status == VXM_OK; p++)
    if (set[p])
      atomic_store_explicit(&has_voxels[p], 1, memory_order_relaxed);
  vxm_free(engine->base.context, set);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

typedef struct unite_work {
  const vxm_parity_union_job *job;
  const vxm_disjoint_passes *passes;
} unite_work;

static vxm_status unite_slab(vxm_opengl *engine, const vxm_slab *slab, void *payload, vxm_error *error) {
  const unite_work *work = payload;
  return make_slab(engine, slab, work->job, work->passes, VXM_GL_RESULT, error);
}

vxm_status vxm_gl_unite(vxm_engine *base, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_disjoint_passes passes = {0};
  size_t parts = job->triangles->split.part_count;
  if (base->keeps && !job->fresh)
    return vxm_fail_to_keep(base, error);
  if (job->part_begin >= job->part_end) {
    if (job->fresh && !base->keeps) /* what stays began as zeros */
      vxm_window_clear(window, window->begin, window->end);
    return VXM_OK;
  }
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_device_cache_triangles(&engine->device_cache, job->triangles, job->placed, error);
  if (status == VXM_OK)
    status = create_passes(&passes, engine, window, job, error);
  if (status == VXM_OK && job->has_voxels)
    status = clear_touched(engine, parts, error);
  unite_work work = {job, &passes};
  if (status == VXM_OK)
    status = vxm_gl_each_slab(engine, window, !job->fresh, unite_slab, &work, error);
  if (status == VXM_OK && job->has_voxels)
    status = take_touched(engine, job->has_voxels, parts, error);
  vxm_disjoint_passes_destroy(&passes);
  vxm_gl_leave(&engine->context);
  return status;
}

/* ---- Votes ---- */

/** The voters of an election: how many are united, and where the words of each are. */
typedef struct voter_set {
  const vxm_vote_job *job;
  vxm_gl_buffer_id words[VXM_VOTERS];
  int count;
} voter_set;

/** The tetrahedra, if not asked, vote as x does. */
static voter_set voters_of(const vxm_vote_job *job) {
  voter_set b = {.job = job, .count = job->tetra ? VXM_VOTERS : VXM_VOTERS - 1};
  for (int v = 0; v < VXM_VOTERS; v++)
    b.words[v] = (vxm_gl_buffer_id)(v < b.count ? VXM_GL_VOTER_X + v : VXM_GL_VOTER_X);
  return b;
}

/** Makes the words of one voter. The lists of all voters share their buffers, so that each is divided anew.
 */
static vxm_status make_voter(vxm_opengl *engine, const vxm_slab *slab, const voter_set *b, int v,
                             vxm_error *error) {
  vxm_parity_union_job job = vxm_voter(b->job, slab->window, v);
  vxm_disjoint_passes passes = {0};
  vxm_progress_part before = vxm_progress_enter((double)v / b->count, (v + 1.0) / b->count);
  vxm_status status = create_passes(&passes, engine, slab->window, &job, error);
  if (status == VXM_OK)
    status = make_slab(engine, slab, &job, &passes, b->words[v], error);
  vxm_disjoint_passes_destroy(&passes);
  vxm_progress_leave(before);
  return status;
}

static vxm_status count_votes(vxm_opengl *engine, const vxm_slab *slab, const voter_set *b, vxm_vote rule,
                              vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  vxm_status status = vxm_gl_use(engine, VXM_GL_VOTE, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 3, b->words[0]);
  vxm_gl_bind(engine, 4, b->words[1]);
  vxm_gl_bind(engine, 5, VXM_GL_RESULT);
  vxm_gl_bind(engine, 6, b->words[2]);
  vxm_gl_bind(engine, 7, b->words[3]);
  vxm_gl_bind(engine, 2, VXM_GL_TALLY);
  gl->Uniform1ui(0, (GLuint)(2 * slab->words));
  gl->Uniform1ui(1, rule == VXM_VOTE_MAJORITY ? 1 : rule == VXM_VOTE_ANY ? 2 : 0);
  vxm_gl_dispatch(gl, 2 * slab->words, false);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return vxm_gl_check(gl, "opengl: counting votes", error);
}

typedef struct election {
  const vxm_vote_job *job;
  voter_set voters;
  vxm_vote_tally *tally;
} election;

static vxm_status elect_slab(vxm_opengl *engine, const vxm_slab *slab, void *payload, vxm_error *error) {
  const election *e = payload;
  uint32_t counted[2] = {0, 0};
  vxm_status status = engine->base.keeps ? vxm_gl_slab_bring(engine, slab, error)
                                         : vxm_gl_slab_upload(engine, VXM_GL_RESULT, slab, error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_TALLY, counted, sizeof counted, error);
  for (int v = 0; v < e->voters.count && status == VXM_OK; v++)
    status = make_voter(engine, slab, &e->voters, v, error);
  if (status == VXM_OK)
    status = count_votes(engine, slab, &e->voters, e->job->rule, error);
  if (status == VXM_OK)
    status = vxm_gl_download(engine, VXM_GL_TALLY, counted, sizeof counted, error);
  e->tally->contested += counted[0];
  e->tally->added |= counted[1] != 0;
  return status;
}

vxm_status vxm_gl_vote(vxm_engine *base, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  size_t parts = job->triangles->split.part_count;
  if (job->part_begin >= job->part_end)
    return VXM_OK;
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_device_cache_triangles(&engine->device_cache, job->triangles, job->placed, error);
  if (status == VXM_OK && job->has_voxels)
    status = clear_touched(engine, parts, error);
  election e = {job, voters_of(job), tally};
  if (status == VXM_OK)
    status = vxm_gl_each_slab(engine, window, false, elect_slab, &e, error);
  if (status == VXM_OK && job->has_voxels)
    status = take_touched(engine, job->has_voxels, parts, error);
  vxm_gl_leave(&engine->context);
  return status;
}
