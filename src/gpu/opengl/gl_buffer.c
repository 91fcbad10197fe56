/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl/opengl.h"

/** Any target will do for making and filling; this one is bound to no shader. */
static const GLenum target = GL_COPY_WRITE_BUFFER;

void vxm_gl_release(vxm_opengl *engine, vxm_gl_buffer_id id) {
  vxm_gl_buffer *buffer = &engine->buffers[id];
  if (buffer->name)
    engine->context.gl.DeleteBuffers(1, &buffer->name);
  vxm_memory_give(engine->base.context, buffer->bytes);
  *buffer = (vxm_gl_buffer){0};
}

vxm_status vxm_gl_reserve(vxm_opengl *engine, vxm_gl_buffer_id id, size_t bytes, vxm_error *error) {
  vxm_gl_buffer *buffer = &engine->buffers[id];
  const vxm_gl *gl = &engine->context.gl;
  bytes = bytes > 0 ? bytes : sizeof(uint32_t);
  if (buffer->bytes >= bytes)
    return VXM_OK;
  if ((int64_t)bytes > engine->base.info.block_bytes)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "%zu bytes are more than the %lld that %s lets a shader use; use --engine cpu", bytes,
                    (long long)engine->base.info.block_bytes, engine->base.info.renderer);
  vxm_memory_give(engine->base.context, buffer->bytes);
  buffer->bytes = 0;
  vxm_status status = vxm_memory_take(engine->base.context, bytes, error);
  if (status != VXM_OK)
    return status;
  buffer->bytes = bytes;
  if (!buffer->name)
    gl->GenBuffers(1, &buffer->name);
  bool is_read = id == VXM_GL_STAGING || id == VXM_GL_STAGING2;
  gl->BindBuffer(target, buffer->name);
  gl->BufferData(target, (GLsizeiptr)bytes, NULL, is_read ? GL_STREAM_READ : GL_DYNAMIC_COPY);
  status = vxm_gl_check(gl, "opengl: making a buffer", error);
  if (status != VXM_OK)
    vxm_gl_release(engine, id);
  return status;
}

vxm_status vxm_gl_reserve_flips(vxm_opengl *engine, size_t bytes, vxm_error *error) {
  const vxm_gl_buffer *flips = &engine->buffers[VXM_GL_FLIPS];
  size_t before = flips->bytes;
  vxm_status status = vxm_gl_reserve(engine, VXM_GL_FLIPS, bytes, error);
  if (status == VXM_OK && flips->bytes != before) {
    engine->context.gl.BindBuffer(target, flips->name);
    engine->context.gl.ClearBufferData(target, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
  }
  return status;
}

GLuint vxm_gl_send_begin(const vxm_gl *gl, const void *data, size_t bytes) {
  GLuint sent = 0;
  gl->GenBuffers(1, &sent);
  gl->BindBuffer(GL_COPY_READ_BUFFER, sent);
  gl->BufferData(GL_COPY_READ_BUFFER, (GLsizeiptr)bytes, data, GL_STREAM_DRAW);
  return sent;
}

void vxm_gl_send_end(vxm_opengl *engine, GLuint sent, vxm_gl_buffer_id id, size_t offset, size_t bytes) {
  const vxm_gl *gl = &engine->context.gl;
  gl->BindBuffer(GL_COPY_READ_BUFFER, sent);
  gl->BindBuffer(target, engine->buffers[id].name);
  gl->CopyBufferSubData(GL_COPY_READ_BUFFER, target, 0, (GLintptr)offset, (GLsizeiptr)bytes);
  gl->DeleteBuffers(1, &sent); /* once it is copied */
}

static vxm_status upload_at(vxm_opengl *engine, vxm_gl_buffer_id id, size_t offset, const void *data,
                            size_t bytes, vxm_error *error) {
  vxm_status status = vxm_gl_reserve(engine, id, offset + bytes, error);
  if (status != VXM_OK || bytes == 0 || !data)
    return status;
  GLuint sent = vxm_gl_send_begin(&engine->context.gl, data, bytes);
  vxm_gl_send_end(engine, sent, id, offset, bytes);
  return vxm_gl_check(&engine->context.gl, "opengl: sending a buffer", error);
}

vxm_status vxm_gl_upload(vxm_opengl *engine, vxm_gl_buffer_id id, const void *data, size_t bytes,
                         vxm_error *error) {
  return upload_at(engine, id, 0, data, bytes, error);
}

void vxm_gl_device_cache_release(vxm_engine *base, vxm_device_cache_id id) {
  vxm_gl_release(vxm_opengl_of(base), (vxm_gl_buffer_id)id);
}

vxm_status vxm_gl_device_cache_upload(vxm_engine *base, vxm_device_cache_id id, size_t offset,
                                      const void *data, size_t bytes, vxm_error *error) {
  return upload_at(vxm_opengl_of(base), (vxm_gl_buffer_id)id, offset, data, bytes, error);
}

void vxm_gl_presence_release(vxm_opengl *engine) {
  vxm_gl_presence *presence = &engine->presence;
  if (presence->texture)
    engine->context.gl.DeleteTextures(1, &presence->texture);
  if (presence->framebuffer)
    engine->context.gl.DeleteFramebuffers(1, &presence->framebuffer);
  vxm_memory_give(engine->base.context, presence->bytes);
  *presence = (vxm_gl_presence){0};
}

void vxm_gl_bind(vxm_opengl *engine, GLuint binding, vxm_gl_buffer_id id) {
  GLenum kind = id == VXM_GL_JOB ? GL_UNIFORM_BUFFER : GL_SHADER_STORAGE_BUFFER;
  engine->context.gl.BindBufferBase(kind, binding, engine->buffers[id].name);
}

vxm_status vxm_gl_download(vxm_opengl *engine, vxm_gl_buffer_id id, void *out, size_t bytes,
                           vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl->BindBuffer(target, engine->buffers[id].name);
  gl->GetBufferSubData(target, 0, (GLsizeiptr)bytes, out); /* mapped, it might move to the host's memory */
  return vxm_gl_check(gl, "opengl: reading a buffer", error);
}
