/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opengl/opengl.h"

#include <string.h>

/** Two slabs under way, their flips and four voters are held: no more than needed to keep a device busy. */
static const int64_t slab_bytes_most = INT64_C(64) << 20;
static const int64_t slice_bytes_most = INT64_C(256) << 20;

static int64_t slab_share(const vxm_opengl *engine) {
  enum { BUFFERS = 9 /**< flips, result, four voters, two staging buffers; and one spare */ };
  static const vxm_gl_buffer_id own[] = {VXM_GL_FLIPS,       VXM_GL_RESULT,      VXM_GL_VOTER_X,
                                         VXM_GL_VOTER_X + 1, VXM_GL_VOTER_X + 2, VXM_GL_VOTER_X + 3,
                                         VXM_GL_STAGING,     VXM_GL_STAGING2};
  size_t held = 0;
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    held += engine->buffers[own[i]].bytes;
  return vxm_slab_share(engine->base.context, held, BUFFERS);
}

vxm_status vxm_gl_slab_slices(int64_t *out, const vxm_opengl *engine, const vxm_window *window,
                              vxm_error *error) {
  const int64_t block = engine->base.info.block_bytes;
  /* Not all that a block may take; and shaders count the bits of a slab in 32 bits. */
  return vxm_slab_slices(out, &engine->base, window, vxm_min(block / 2, slice_bytes_most),
                         vxm_min(vxm_min(block, slab_bytes_most), slab_share(engine)), error);
}

vxm_status vxm_gl_slab_upload(vxm_opengl *engine, vxm_gl_buffer_id id, const vxm_slab *slab,
                              vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  size_t bytes = vxm_slab_slice_words(slab) * sizeof(uint64_t);
  vxm_status status = vxm_gl_reserve(engine, id, slab->words * sizeof(uint64_t), error);
  if (status != VXM_OK)
    return status;
  size_t all = (size_t)(slab->end - slab->begin) * bytes;
  GLuint sent = vxm_gl_send_begin(gl, NULL, all);
  for (int64_t k = slab->begin; k < slab->end; k++)
    gl->BufferSubData(GL_COPY_READ_BUFFER, (GLintptr)((size_t)(k - slab->begin) * bytes), (GLsizeiptr)bytes,
                      vxm_slab_slice_at(slab, slab->window->words, k));
  vxm_gl_send_end(engine, sent, id, 0, all);
  return vxm_gl_check(gl, "opengl: sending voxels", error);
}

vxm_status vxm_gl_return_begin(vxm_opengl *engine, vxm_gl_return *back, vxm_error *error) {
  const vxm_gl *gl = &engine->context.gl;
  size_t bytes = back->slab.words * sizeof(uint64_t);
  vxm_gl_buffer_id staging = (vxm_gl_buffer_id)(VXM_GL_STAGING + back->staging);
  vxm_status status = vxm_gl_reserve(engine, staging, bytes, error);
  if (status != VXM_OK)
    return status;
  gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[staging].name);
  gl->BindBuffer(GL_COPY_READ_BUFFER, engine->buffers[VXM_GL_RESULT].name);
  gl->CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, (GLsizeiptr)bytes);
  back->fence = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl->Flush();
  return vxm_gl_check(gl, "opengl: drawing", error);
}

vxm_status vxm_gl_return_end(vxm_opengl *engine, vxm_gl_return *back, vxm_error *error) {
  enum { WAIT_NS = 1000000000 };
  const vxm_gl *gl = &engine->context.gl;
  if (!back->fence)
    return VXM_OK;
  GLenum waited;
  do
    waited = gl->ClientWaitSync(back->fence, GL_SYNC_FLUSH_COMMANDS_BIT, WAIT_NS);
  while (waited == GL_TIMEOUT_EXPIRED &&
         (!gl->GetGraphicsResetStatus || gl->GetGraphicsResetStatus() == GL_NO_ERROR));
  gl->DeleteSync(back->fence);
  back->fence = NULL;
  const vxm_slab *slab = &back->slab;
  size_t bytes = slab->words * sizeof(uint64_t);
  gl->BindBuffer(GL_COPY_WRITE_BUFFER, engine->buffers[VXM_GL_STAGING + back->staging].name);
  const uint64_t *data = gl->MapBufferRange(GL_COPY_WRITE_BUFFER, 0, (GLsizeiptr)bytes, GL_MAP_READ_BIT);
  if (data) {
    vxm_slab_take(slab, slab->window->words, data, back->is_or);
    gl->UnmapBuffer(GL_COPY_WRITE_BUFFER);
  }
  vxm_status status = vxm_gl_check(gl, "opengl: reading voxels", error);
  if (status == VXM_OK && (!data || waited == GL_WAIT_FAILED))
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "opengl: the driver does not give the voxels back");
  return status;
}
