/* SPDX-License-Identifier: BSD-3-Clause */
/** Surfaces by OpenGL: small triangles in a compute shader, large ones dilated in a geometry shader and
 * drawn. Which voxels belong to a triangle is told exactly, by the tests of the CPU. */
#include "gpu/opengl/gl_solid.h"

enum { FEW_COLUMNS = 32, LARGE_HEADER = 4 };

/** The uniform block of shaders/touching.glsl. */
typedef struct surface_job {
  vxm_slab_surface slab;
  int32_t view[4];
} surface_job;

static surface_job job_of(const vxm_opengl *engine, const vxm_surface *surface, const vxm_slab *slab,
                          vxm_surface_kind kind) {
  surface_job job = {.slab = vxm_slab_surface_of(slab, surface, kind)};
  job.slab.few_columns = engine->can_pull_late ? FEW_COLUMNS : UINT32_MAX;
  return job;
}

static void bind(vxm_opengl *engine) {
  vxm_gl_bind(engine, 0, VXM_GL_JOB);
  vxm_gl_bind(engine, 0, VXM_GL_SURFACE_POINTS);
  vxm_gl_bind(engine, 1, VXM_GL_SURFACE_CORNERS);
  vxm_gl_bind(engine, 3, VXM_GL_RESULT);
  vxm_gl_bind(engine, 4, VXM_GL_LARGE);
}

static vxm_status find(vxm_opengl *engine, const surface_job *job, vxm_error *error) {
  static const uint32_t header[LARGE_HEADER] = {0, 1, 0, 0};
  const vxm_gl *gl = &engine->context.gl;
  vxm_status status = vxm_gl_reserve(
      engine, VXM_GL_LARGE, (LARGE_HEADER + (size_t)job->slab.triangle_count) * sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_LARGE, header, sizeof header, error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_JOB, job, sizeof *job, error);
  if (status == VXM_OK)
    status = vxm_gl_use(engine, VXM_GL_FIND_SURFACE, error);
  if (status != VXM_OK)
    return status;
  bind(engine);
  vxm_gl_dispatch(gl, job->slab.triangle_count, false);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  return VXM_OK;
}

/** One viewport serves triangles seen along any axis, so that it is as wide and high as the longest. */
static vxm_status draw(vxm_opengl *engine, surface_job *job, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  int64_t most = engine->base.info.viewport, longest = 0;
  for (int a = 0; a < 3; a++)
    longest = vxm_max(longest, job->slab.last[a]);
  vxm_status status = vxm_gl_use(engine, VXM_GL_DRAW_SURFACE, error);
  if (status != VXM_OK)
    return status;
  bind(engine);
  gl->BindFramebuffer(GL_FRAMEBUFFER, engine->framebuffer);
  gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, engine->buffers[VXM_GL_LARGE].name);
  for (int64_t v = 0; v < longest && status == VXM_OK; v += most)
    for (int64_t u = 0; u < longest && status == VXM_OK; u += most) {
      job->view[0] = (int32_t)u;
      job->view[1] = (int32_t)v;
      job->view[2] = (int32_t)vxm_min(most, longest - u);
      job->view[3] = (int32_t)vxm_min(most, longest - v);
      status = vxm_gl_upload(engine, VXM_GL_JOB, job, sizeof *job, error);
      gl->FramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_WIDTH, job->view[2]);
      gl->FramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_HEIGHT, job->view[3]);
      gl->Viewport(0, 0, job->view[2], job->view[3]);
      gl->DrawArraysIndirect(GL_POINTS, NULL);
    }
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return status;
}

typedef struct drawing {
  const vxm_surface *surface;
  vxm_surface_kind kind;
  bool is_fresh;
} drawing;

static vxm_status draw_slab(vxm_engine *base, const vxm_slab *slab, int into, void *payload,
                            vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  const drawing *d = payload;
  const vxm_gl *gl = &engine->context.gl;
  surface_job job = job_of(engine, d->surface, slab, d->kind);
  vxm_status status = vxm_gl_reserve(engine, (vxm_gl_buffer_id)into, slab->words * sizeof(uint64_t), error);
  if (status != VXM_OK)
    return status;
  if (base->keeps && !d->is_fresh)
    status = vxm_gl_slab_bring(engine, slab, error);
  else {
    gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[into].name);
    gl->ClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
  }
  if (status == VXM_OK)
    status = find(engine, &job, error);
  if (status == VXM_OK && engine->can_pull_late)
    status = draw(engine, &job, error);
  if (status == VXM_OK)
    status = vxm_gl_check(gl, "opengl: drawing a surface", error);
  return status == VXM_OK ? vxm_progress(engine->base.context, "voxelizing the surface", 1, error) : status;
}

vxm_status vxm_gl_surface(vxm_engine *base, const vxm_surface *surface, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_device_cache_surface(&engine->device_cache, surface, error);
  bool needs_host = base->keeps && engine->device_cache.oversized_surface.count > 0;
  drawing d = {surface, kind, is_fresh};
  if (status == VXM_OK && !needs_host)
    status = vxm_gl_each_slab(base, window, !is_fresh, draw_slab, &d, error);
  vxm_gl_leave(&engine->context);
  if (status == VXM_OK && needs_host)
    return vxm_fail_to_keep(base, error);
  return status == VXM_OK && !base->keeps ? vxm_oversized_surface_add(&engine->device_cache.oversized_surface,
                                                                      surface, window, kind, error)
                                          : status;
}
