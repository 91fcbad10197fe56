/* SPDX-License-Identifier: BSD-3-Clause */
/** The colour function of Rueda et al. as a fragment shader: slice after slice across x, a fragment per
 * voxel. */
#include "gpu/opengl/gl_solid.h"
#include "grid/space.h"

#include <string.h>

/** The uniform block of shaders/color.frag. */
typedef struct color_job {
  int32_t dims[4], slice[4];
  float origin[4], size[4];
} color_job;

typedef struct coloring {
  vxm_opengl *engine;
  const vxm_color_job *job;
  GLuint program, texture, framebuffer;
  color_job gl_job;
} coloring;

static color_job job_of(const vxm_color_job *job) {
  const vxm_space *space = &job->grid->space;
  color_job out = {.slice = {0, job->parts != NULL}};
  for (int a = 0; a < 3; a++) {
    out.dims[a] = (int32_t)space->dims[a];
    out.origin[a] = (float)space->origin[a];
    out.size[a] = (float)space->voxel_size[a];
  }
  out.dims[3] = (int32_t)(2 * job->grid->row_words);
  out.origin[3] = (float)(1 / vxm_space_longest_side(space));
  return out;
}

/** The function is built in, or the caller's; its lines are counted from 1 in the driver's messages. */
static vxm_status make_program(coloring *c, vxm_error *error) {
  static const char *const built_in[] = {[VXM_COLOR_NOISE] = "noise.glsl color_noise.glsl color.frag",
                                         [VXM_COLOR_POSITION] = "color_position.glsl color.frag",
                                         [VXM_COLOR_PART] = "color_part.glsl color.frag",
                                         [VXM_COLOR_GLSL] = "noise.glsl | color.frag"};
  const char *const stages[] = {"color.vert", built_in[c->job->options->by], NULL};
  return vxm_gl_program_with(&c->program, &c->engine->context.gl, stages, "", c->job->options->source, error);
}

static vxm_status make_target(coloring *c, vxm_error *error) {
  const vxm_gl *gl = &c->engine->context.gl;
  const int64_t *dims = c->job->grid->space.dims;
  if (vxm_max(dims[1], dims[2]) > c->engine->base.info.viewport)
    return vxm_fail(error, VXM_ERROR_RANGE, "opengl: a slice to colour is larger than %lld pixels",
                    (long long)c->engine->base.info.viewport);
  gl->GenTextures(1, &c->texture);
  gl->BindTexture(GL_TEXTURE_2D_ARRAY, c->texture);
  gl->TexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_RGBA8, (GLsizei)dims[2], (GLsizei)dims[1], 1);
  gl->GenFramebuffers(1, &c->framebuffer);
  gl->BindFramebuffer(GL_FRAMEBUFFER, c->framebuffer);
  gl->FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, c->texture, 0, 0);
  gl->DrawBuffers(1, &(const GLenum){GL_COLOR_ATTACHMENT0});
  gl->Viewport(0, 0, (GLsizei)dims[2], (GLsizei)dims[1]);
  gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
  return vxm_gl_check(gl, "opengl: making a target for colours", error);
}

static vxm_status upload_parts(coloring *c, size_t slice, size_t count, vxm_error *error) {
  vxm_opengl *engine = c->engine;
  if (!c->job->parts)
    return vxm_gl_reserve(engine, VXM_GL_LARGE, sizeof(uint32_t), error);
  vxm_status status = vxm_gl_reserve(engine, VXM_GL_LARGE, (count + 1) / 2 * sizeof(uint32_t), error);
  if (status != VXM_OK)
    return status;
  return vxm_gl_upload(engine, VXM_GL_LARGE, c->job->parts + slice * count, count * sizeof *c->job->parts,
                       error);
}

static vxm_status draw_slice(coloring *c, int64_t slice, uint8_t *values, vxm_error *error) {
  vxm_opengl *engine = c->engine;
  const vxm_gl *gl = &engine->context.gl;
  const int64_t *dims = c->job->grid->space.dims;
  size_t count = (size_t)(dims[1] * dims[2]);
  c->gl_job.slice[0] = (int32_t)slice;
  vxm_status status = upload_parts(c, (size_t)slice, count, error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_JOB, &c->gl_job, sizeof c->gl_job, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 0, VXM_GL_JOB);
  vxm_gl_bind(engine, 3, VXM_GL_RESULT);
  vxm_gl_bind(engine, 4, VXM_GL_LARGE);
  gl->DrawArrays(GL_TRIANGLES, 0, 3);
  gl->ReadPixels(0, 0, (GLsizei)dims[2], (GLsizei)dims[1], GL_RGBA, GL_UNSIGNED_BYTE,
                 values + 4 * count * (size_t)slice);
  status = vxm_gl_check(gl, "opengl: colouring", error);
  return status == VXM_OK
             ? vxm_progress(engine->base.context, "colouring", (double)(slice + 1) / (double)dims[0], error)
             : status;
}

vxm_status vxm_gl_color(vxm_engine *base, uint8_t *values, const vxm_color_job *job, vxm_error *error) {
  vxm_opengl *engine = vxm_opengl_of(base);
  const vxm_gl *gl = &engine->context.gl;
  coloring c = {.engine = engine, .job = job, .gl_job = job_of(job)};
  vxm_status status = vxm_gl_enter(&engine->context, error);
  if (status != VXM_OK)
    return status;
  status = make_program(&c, error);
  if (status == VXM_OK)
    status = make_target(&c, error);
  if (status == VXM_OK)
    status = vxm_gl_upload(engine, VXM_GL_RESULT, job->grid->words, job->grid->word_count * sizeof(uint64_t),
                           error);
  gl->UseProgram(c.program);
  for (int64_t i = 0; i < job->grid->space.dims[0] && status == VXM_OK; i++)
    status = draw_slice(&c, i, values, error);
  gl->UseProgram(0);
  if (c.program)
    gl->DeleteProgram(c.program);
  if (c.framebuffer)
    gl->DeleteFramebuffers(1, &c.framebuffer);
  if (c.texture)
    gl->DeleteTextures(1, &c.texture);
  vxm_gl_leave(&engine->context);
  return status;
}
