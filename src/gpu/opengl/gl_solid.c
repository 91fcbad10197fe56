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

vxm_status vxm_gl_each_slab(vxm_engine *base, const vxm_window *window, bool is_or, vxm_slab_fn make,
                            void *payload, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_gl_return back[2] = {{.staging = 0}, {.staging = 1}};
  int64_t slices = 1;
  int which = 0;
  vxm_status status = vxm_gl_slab_slices(&slices, engine, window, error);
  for (int64_t k = window->begin; k < window->end && status == VXM_OK; k += slices, which ^= 1) {
    vxm_slab slab = vxm_slab_of(window, k, slices);
    vxm_progress_part before = vxm_slab_progress(&slab);
    status = make(base, &slab, VXM_GL_RESULT, payload, error);
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
static vxm_status unite(vxm_engine *base, const vxm_slab *slab, const vxm_parity_union_job *job,
                        vxm_disjoint_passes *passes, int into, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  bool slices = engine->options.gl_method != VXM_GL_COLUMNS && vxm_gl_can_slice(job);
  return (slices ? vxm_gl_slices : vxm_gl_columns)(engine, slab, job, passes, (vxm_gl_buffer_id)into, error);
}

static vxm_status divide(vxm_disjoint_passes *out, vxm_engine *base, const vxm_window *window,
                         const vxm_parity_union_job *job, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  /* Slices move points, and the apex in any case a little. */
  double move = engine->options.displacement;
  int64_t margin = engine->base.wants_apexes ? (int64_t)(move < 1 << 20 ? move : 1 << 20) + 1 : 0;
  return vxm_device_cache_passes(out, &engine->device_cache, window, job, margin, SIZE_MAX, error);
}

static vxm_status clear_touched(vxm_engine *base, size_t part_count, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_status status = vxm_gl_reserve(engine, VXM_GL_TOUCHED, part_count * sizeof(uint32_t), error);
  if (status != VXM_OK)
    return status;
  const vxm_gl *gl = &engine->context.gl;
  gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[VXM_GL_TOUCHED].name);
  gl->ClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
  return VXM_OK;
}

static vxm_status read_touched(vxm_engine *base, uint32_t *out, size_t part_count, vxm_error *error) {
  return vxm_gl_download(vxm_opengl_of(base), VXM_GL_TOUCHED, out, part_count * sizeof *out, error);
}

static vxm_status bring(vxm_engine *base, const vxm_slab *slab, int into, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  return base->keeps ? vxm_gl_slab_bring(engine, slab, error)
                     : vxm_gl_slab_upload(engine, (vxm_gl_buffer_id)into, slab, error);
}

static vxm_status count_votes(vxm_engine *base, const vxm_slab *slab, const int voters[VXM_VOTERS],
                              uint32_t rule, int result, uint32_t counted[2], vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  const vxm_gl *gl = &engine->context.gl;
  const size_t bytes = 2 * sizeof *counted;
  vxm_status status = vxm_gl_upload(engine, VXM_GL_TALLY, counted, bytes, error);
  if (status == VXM_OK)
    status = vxm_gl_use(engine, VXM_GL_VOTE, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 3, (vxm_gl_buffer_id)voters[0]);
  vxm_gl_bind(engine, 4, (vxm_gl_buffer_id)voters[1]);
  vxm_gl_bind(engine, 5, (vxm_gl_buffer_id)result);
  vxm_gl_bind(engine, 6, (vxm_gl_buffer_id)voters[2]);
  vxm_gl_bind(engine, 7, (vxm_gl_buffer_id)voters[3]);
  vxm_gl_bind(engine, 2, VXM_GL_TALLY);
  gl->Uniform1ui(0, (GLuint)(2 * slab->words));
  gl->Uniform1ui(1, rule);
  vxm_gl_dispatch(gl, 2 * slab->words, false);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  status = vxm_gl_check(gl, "opengl: counting votes", error);
  return status == VXM_OK ? vxm_gl_download(engine, VXM_GL_TALLY, counted, bytes, error) : status;
}

static const vxm_slab_solid slab_solid = {.voter_x = VXM_GL_VOTER_X,
                                          .each_slab = vxm_gl_each_slab,
                                          .divide = divide,
                                          .unite = unite,
                                          .bring = bring,
                                          .count_votes = count_votes,
                                          .clear_touched = clear_touched,
                                          .read_touched = read_touched};

vxm_status vxm_gl_unite(vxm_engine *base, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_slab_solid_unite(&slab_solid, &engine->device_cache, window, job, error);
  vxm_gl_leave(&engine->context);
  return status;
}

vxm_status vxm_gl_vote(vxm_engine *base, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_slab_solid_vote(&slab_solid, &engine->device_cache, window, job, tally, error);
  vxm_gl_leave(&engine->context);
  return status;
}
