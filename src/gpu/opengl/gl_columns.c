/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The fast path: all triangles of a pass at once, along one axis. A compute shader flips what triangles of
 * few columns cross and lists the others, which are drawn; fragments flip what these cross. Then a prefix XOR
 * along the axis. Whether a triangle covers a column, and where it crosses it, is computed in the CPU's
 * integers (raster_body.inc).
 */
#include "gpu/opengl/opengl.h"

enum {
  FEW_COLUMNS = 24, /**< a triangle with no more is not worth drawing */
  LARGE_HEADER = 4  /**< words of an indirect draw */
};

static vxm_gl_job job_of(const vxm_opengl *engine, const vxm_slab *slab, const vxm_parity_union_job *job) {
  vxm_gl_job out = {.columns = vxm_slab_columns_of(slab, job)};
  out.columns.few_columns = engine->can_pull ? FEW_COLUMNS : UINT32_MAX;
  return out;
}

static vxm_status find(vxm_opengl *engine, const vxm_gl_job *gl_job, vxm_error *error) {
  static const uint32_t header[LARGE_HEADER] = {0, 1, 0, 0};
  const vxm_gl *gl = &engine->context.gl;
  size_t large = (LARGE_HEADER + (size_t)gl_job->columns.triangle_count) * sizeof(uint32_t);
  vxm_status status = vxm_gl_reserve(engine, VXM_GL_LARGE, large, error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_LARGE, header, sizeof header, error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_JOB, gl_job, sizeof *gl_job, error);
  if (status == VXM_OK)
    status = vxm_gl_use(engine, VXM_GL_FIND_COLUMNS, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 0, VXM_GL_JOB);
  vxm_gl_bind(engine, 0, VXM_GL_POINTS);
  vxm_gl_bind(engine, 1, VXM_GL_CORNERS);
  vxm_gl_bind(engine, 2, VXM_GL_ORDER);
  vxm_gl_bind(engine, 3, VXM_GL_FLIPS);
  vxm_gl_bind(engine, 4, VXM_GL_LARGE);
  vxm_gl_dispatch(gl, gl_job->columns.triangle_count, false);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  return VXM_OK;
}

/** Draws the listed triangles, in viewports as large as the driver has them. */
static vxm_status draw(vxm_opengl *engine, vxm_gl_job *gl_job, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  int64_t most = engine->base.info.viewport;
  vxm_status status = vxm_gl_use(engine, VXM_GL_DRAW_COLUMNS, error);
  if (status != VXM_OK)
    return status;
  gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, engine->framebuffer);
  gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, engine->buffers[VXM_GL_LARGE].name);
  for (int64_t v = gl_job->columns.first[1]; v < gl_job->columns.last[1] && status == VXM_OK; v += most)
    for (int64_t u = gl_job->columns.first[0]; u < gl_job->columns.last[0] && status == VXM_OK; u += most) {
      gl_job->view[0] = (int32_t)u;
      gl_job->view[1] = (int32_t)v;
      gl_job->view[2] = (int32_t)vxm_min(most, gl_job->columns.last[0] - u);
      gl_job->view[3] = (int32_t)vxm_min(most, gl_job->columns.last[1] - v);
      status = vxm_gl_upload(engine, VXM_GL_JOB, gl_job, sizeof *gl_job, error);
      gl->FramebufferParameteri(GL_DRAW_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_WIDTH, gl_job->view[2]);
      gl->FramebufferParameteri(GL_DRAW_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_HEIGHT, gl_job->view[3]);
      gl->Viewport(0, 0, gl_job->view[2], gl_job->view[3]);
      gl->DrawArraysIndirect(GL_TRIANGLES, NULL);
    }
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return status;
}

static vxm_status flip_far(vxm_opengl *engine, const vxm_gl_job *gl_job, const vxm_parity_union_job *job,
                           const vxm_disjoint_passes *passes, size_t pass, vxm_error *error) {
  uint32_t *bits = NULL;
  size_t count = 0;
  if (engine->device_cache.oversized.count == 0)
    return VXM_OK;
  vxm_status status = vxm_oversized_flips(&bits, &count, &engine->device_cache.oversized, &gl_job->columns,
                                          job, passes, pass, error);
  if (status == VXM_OK && count > 0)
    status = vxm_gl_upload(engine, VXM_GL_LARGE, bits, count * sizeof *bits, error);
  if (status == VXM_OK && count > 0)
    status = vxm_gl_use(engine, VXM_GL_FLIP, error);
  if (status == VXM_OK && count > 0) {
    vxm_gl_bind(engine, 3, VXM_GL_FLIPS);
    vxm_gl_bind(engine, 4, VXM_GL_LARGE);
    engine->context.gl.Uniform1ui(0, (GLuint)count);
    vxm_gl_dispatch(&engine->context.gl, count, false);
    engine->context.gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
  vxm_free(engine->base.context, bits);
  return status;
}

vxm_status vxm_gl_touch(vxm_opengl *engine, const vxm_slab *slab, const vxm_disjoint_passes *passes,
                        size_t pass, vxm_error *error) {
  size_t first = pass > 0 ? passes->box_end[pass - 1] : 0, count = passes->box_end[pass] - first;
  vxm_status status = vxm_gl_use(engine, VXM_GL_TOUCH, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 3, VXM_GL_FLIPS);
  vxm_gl_bind(engine, 4, VXM_GL_BOXES);
  vxm_gl_bind(engine, 5, VXM_GL_TOUCHED);
  engine->context.gl.Uniform4ui(0, (GLuint)first, (GLuint)count, (GLuint)slab->begin, (GLuint)slab->end);
  engine->context.gl.Uniform1ui(1, (GLuint)slab->window->middle_dim);
  vxm_gl_dispatch(&engine->context.gl, count, true);
  /* What comes next clears the flips. */
  engine->context.gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return VXM_OK;
}

static vxm_status fold(vxm_opengl *engine, const vxm_slab *slab, int axis, vxm_gl_buffer_id into,
                       bool is_added, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  const vxm_window *window = slab->window;
  bool along = axis == window->layout.fast;
  vxm_status status = vxm_gl_use(engine, along ? VXM_GL_FOLD_ROWS : VXM_GL_FOLD_ACROSS, error);
  if (status != VXM_OK)
    return status;
  GLuint words = (GLuint)(2 * slab->row_words), rows = (GLuint)window->middle_dim;
  GLuint slices = (GLuint)(slab->end - slab->begin), used = (GLuint)((window->fast_dim + 31) / 32);
  vxm_gl_bind(engine, 3, VXM_GL_FLIPS);
  vxm_gl_bind(engine, 5, into);
  gl->Uniform1ui(1, is_added);
  if (along) {
    uint32_t tail = window->fast_dim % 32 ? (UINT32_C(1) << (window->fast_dim % 32)) - 1 : UINT32_MAX;
    gl->Uniform4ui(0, rows * slices, words, used, tail);
    vxm_gl_dispatch(gl, (uint64_t)rows * slices, false);
  } else {
    bool middle = axis == window->layout.middle;
    GLuint side = middle ? words : words * rows, lines = middle ? words * slices : side;
    gl->Uniform4ui(0, lines, side, words * rows, 0);
    gl->Uniform4ui(2, middle ? rows : slices, side, 0, 0);
    vxm_gl_dispatch(gl, lines, false);
  }
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return VXM_OK;
}

vxm_status vxm_gl_columns(vxm_opengl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                          const vxm_disjoint_passes *passes, vxm_gl_buffer_id into, vxm_error *error) {
  vxm_gl_job gl_job = job_of(engine, slab, job);
  size_t bytes = slab->words * sizeof(uint64_t), begin = 0;
  vxm_status status = vxm_gl_reserve_flips(engine, bytes, error);
  if (status == VXM_OK)
    status = vxm_gl_reserve(engine, into, bytes, error);
  for (size_t p = 0; p < passes->count && status == VXM_OK; p++) {
    gl_job.columns.ordered = passes->ordered;
    gl_job.columns.triangle_first = (uint32_t)(passes->ordered ? begin : passes->first);
    gl_job.columns.triangle_count = (uint32_t)(passes->triangle_end[p] - begin);
    begin = passes->triangle_end[p];
    if (gl_job.columns.triangle_count > 0)
      status = find(engine, &gl_job, error);
    if (status == VXM_OK && gl_job.columns.triangle_count > 0 && engine->can_pull)
      status = draw(engine, &gl_job, error);
    if (status == VXM_OK)
      status = flip_far(engine, &gl_job, job, passes, p, error);
    if (status == VXM_OK && job->has_voxels)
      status = vxm_gl_touch(engine, slab, passes, p, error);
    if (status == VXM_OK)
      status = fold(engine, slab, job->axis, into, p > 0, error);
    if (status == VXM_OK)
      status = vxm_gl_check(&engine->context.gl, "opengl: drawing columns", error);
    if (status == VXM_OK)
      status = vxm_progress(engine->base.context, job->phase, (double)(p + 1) / (double)passes->count, error);
  }
  return status;
}
