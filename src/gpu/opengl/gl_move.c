/* SPDX-License-Identifier: BSD-3-Clause */
/** Variants of a model that stays on the device: a vertex shader moves its points (Ogayar et al., section
 * III-B), once for all that is drawn of them. */
#include "gpu/opengl/gl_solid.h"

/** Draws all points, but nothing of them: the shader writes where they are. */
static vxm_status draw(vxm_opengl *engine, const vxm_device_transform_job *job, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  vxm_status status = vxm_gl_upload(engine, VXM_GL_JOB, job, sizeof *job, error);
  if (status == VXM_OK)
    status = vxm_gl_use(engine, VXM_GL_MOVE, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 0, VXM_GL_JOB);
  vxm_gl_bind(engine, 0, VXM_GL_ORIGINALS);
  vxm_gl_bind(engine, 1, VXM_GL_ENTRIES);
  vxm_gl_bind(engine, 2, VXM_GL_NOISE);
  vxm_gl_bind(engine, 3, VXM_GL_POINTS);
  gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, engine->framebuffer);
  gl->FramebufferParameteri(GL_DRAW_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_WIDTH, 1);
  gl->FramebufferParameteri(GL_DRAW_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_HEIGHT, 1);
  gl->Enable(GL_RASTERIZER_DISCARD);
  gl->DrawArrays(GL_POINTS, 0, (GLsizei)job->count);
  gl->Disable(GL_RASTERIZER_DISCARD);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return vxm_gl_check(gl, "opengl: moving points", error);
}

static vxm_status move(vxm_opengl *engine, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                       vxm_error *error) {
  const vxm_triangle_set *triangles = job->triangles;
  vxm_device_transform_job gl_job = vxm_device_transform_job_of(placed, job->motion);
  if (!vxm_device_cache_motion(&engine->device_cache, job->motion, triangles->point_count))
    return VXM_OK;
  vxm_status status = draw(engine, &gl_job, error);
  if (status == VXM_OK)
    status = vxm_gl_download(engine, VXM_GL_POINTS, placed->narrow,
                             triangles->first_apex * sizeof *placed->narrow, error);
  return status == VXM_OK ? vxm_device_cache_moved(&engine->device_cache, placed, job, done, error) : status;
}

vxm_status vxm_gl_move(vxm_engine *base, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                       vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  if (!engine->base.info.moves)
    return VXM_OK;
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  engine->base.info.moves = vxm_gl_use(engine, VXM_GL_MOVE, NULL) == VXM_OK;
  if (engine->base.info.moves)
    status = move(engine, placed, job, done, error);
  vxm_gl_leave(&engine->context);
  return status;
}
