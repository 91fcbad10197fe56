/* SPDX-License-Identifier: BSD-3-Clause */
/** Buffers of the device, and slabs on their way to and from it. */
#include "gpu/opencl/opencl.h"

#include <string.h>

void vxm_cl_release(vxm_opencl *engine, vxm_cl_buffer_id id) {
  vxm_cl_buffer *buffer = &engine->buffers[id];
  if (buffer->mem)
    engine->cl->ReleaseMemObject(buffer->mem);
  vxm_memory_give(engine->base.context, buffer->bytes);
  *buffer = (vxm_cl_buffer){0};
}

vxm_status vxm_cl_reserve(vxm_opencl *engine, vxm_cl_buffer_id id, size_t bytes, vxm_error *error) {
  vxm_cl_buffer *buffer = &engine->buffers[id];
  cl_int code;
  bytes = bytes > sizeof(uint64_t) ? bytes : sizeof(uint64_t);
  if (buffer->bytes >= bytes)
    return VXM_OK;
  if (bytes > (uint64_t)engine->base.info.block_bytes)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "%zu bytes are more than the %lld that %s gives to a buffer; use --engine cpu", bytes,
                    (long long)engine->base.info.block_bytes, engine->base.info.renderer);
  vxm_cl_release(engine, id); /* after all that was queued, which the driver counts */
  vxm_status status = vxm_memory_take(engine->base.context, bytes, error);
  if (status != VXM_OK)
    return status;
  buffer->bytes = bytes;
  buffer->mem = engine->cl->CreateBuffer(engine->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
  if (code == CL_SUCCESS)
    return VXM_OK;
  buffer->mem = NULL;
  vxm_cl_release(engine, id);
  return vxm_cl_check(code, "making a buffer", error);
}

static vxm_status fill_zero(vxm_opencl *engine, vxm_cl_buffer_id id, size_t bytes, vxm_error *error) {
  static const uint32_t zero = 0;
  bytes = (bytes + sizeof zero - 1) / sizeof zero * sizeof zero;
  return vxm_cl_check(engine->cl->EnqueueFillBuffer(engine->queue, engine->buffers[id].mem, &zero,
                                                    sizeof zero, 0, bytes, 0, NULL, NULL),
                      "clearing a buffer", error);
}

vxm_status vxm_cl_reserve_flips(vxm_opencl *engine, size_t bytes, vxm_error *error) {
  const vxm_cl_buffer *flips = &engine->buffers[VXM_CL_FLIPS];
  cl_mem before = flips->bytes >= bytes ? flips->mem : NULL;
  vxm_status status = vxm_cl_reserve(engine, VXM_CL_FLIPS, bytes, error);
  if (status != VXM_OK || before)
    return status;
  return fill_zero(engine, VXM_CL_FLIPS, flips->bytes, error);
}

vxm_status vxm_cl_clear(vxm_opencl *engine, vxm_cl_buffer_id id, size_t bytes, vxm_error *error) {
  vxm_status status = vxm_cl_reserve(engine, id, bytes, error);
  return status == VXM_OK && bytes > 0 ? fill_zero(engine, id, bytes, error) : status;
}

static vxm_status upload_at(vxm_opencl *engine, vxm_cl_buffer_id id, size_t offset, const void *data,
                            size_t bytes, vxm_error *error) {
  vxm_status status = vxm_cl_reserve(engine, id, offset + bytes, error);
  if (status != VXM_OK || bytes == 0 || !data)
    return status;
  return vxm_cl_check(engine->cl->EnqueueWriteBuffer(engine->queue, engine->buffers[id].mem, CL_TRUE, offset,
                                                     bytes, data, 0, NULL, NULL),
                      "sending a buffer", error);
}

vxm_status vxm_cl_upload(vxm_opencl *engine, vxm_cl_buffer_id id, const void *data, size_t bytes,
                         vxm_error *error) {
  return upload_at(engine, id, 0, data, bytes, error);
}

void vxm_cl_device_cache_release(vxm_engine *base, vxm_device_cache_id id) {
  vxm_cl_release(vxm_opencl_of(base), (vxm_cl_buffer_id)id);
}

vxm_status vxm_cl_device_cache_upload(vxm_engine *base, vxm_device_cache_id id, size_t offset,
                                      const void *data, size_t bytes, vxm_error *error) {
  return upload_at(vxm_opencl_of(base), (vxm_cl_buffer_id)id, offset, data, bytes, error);
}

vxm_status vxm_cl_download(vxm_opencl *engine, vxm_cl_buffer_id id, size_t offset, void *out, size_t bytes,
                           vxm_error *error) {
  if (bytes == 0)
    return VXM_OK;
  return vxm_cl_check(engine->cl->EnqueueReadBuffer(engine->queue, engine->buffers[id].mem, CL_TRUE, offset,
                                                    bytes, out, 0, NULL, NULL),
                      "reading a buffer", error);
}

/* ---- Slabs ---- */

static int64_t slab_share(const vxm_opencl *engine) {
  enum {
    BUFFERS = 11 /**< flips, two results and four voters; and as much for lists of tiles and what is added */
  };
  static const vxm_cl_buffer_id own[] = {VXM_CL_FLIPS,      VXM_CL_RESULT,      VXM_CL_RESULT2,
                                         VXM_CL_VOTER_X,    VXM_CL_VOTER_X + 1, VXM_CL_VOTER_X + 2,
                                         VXM_CL_VOTER_X + 3};
  size_t held = 0;
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    held += engine->buffers[own[i]].bytes;
  return vxm_slab_share(engine->base.context, held, BUFFERS);
}

vxm_status vxm_cl_slab_slices(int64_t *out, const vxm_opencl *engine, const vxm_window *window,
                              vxm_error *error) {
  /* Bits of a slab are counted in 32 bits; flips, two results and four voters may be held. */
  const int64_t bytes_most = INT64_C(256) << 20, buffers = 8;
  const vxm_engine_info *info = &engine->base.info;
  const int64_t slab_most = vxm_min(vxm_min(info->block_bytes, info->global_bytes / buffers), bytes_most);
  return vxm_slab_slices(out, &engine->base, window, vxm_min(info->block_bytes, bytes_most),
                         vxm_min(slab_most, slab_share(engine)), error);
}

vxm_status vxm_cl_slab_upload(vxm_opencl *engine, vxm_cl_buffer_id id, const vxm_slab *slab,
                              vxm_error *error) {
  size_t bytes = vxm_slab_slice_words(slab) * sizeof(uint64_t);
  vxm_status status = vxm_cl_reserve(engine, id, slab->words * sizeof(uint64_t), error);
  for (int64_t k = slab->begin; k < slab->end && status == VXM_OK; k++)
    status = vxm_cl_check(engine->cl->EnqueueWriteBuffer(engine->queue, engine->buffers[id].mem, CL_TRUE,
                                                         (size_t)(k - slab->begin) * bytes, bytes,
                                                         vxm_slab_slice_at(slab, slab->window->words, k), 0,
                                                         NULL, NULL),
                          "sending voxels", error);
  return status;
}

/** Whether the words of the slab lie in the window as they do in the slab. */
static bool is_dense(const vxm_slab *slab) {
  return slab->window->slice_words == vxm_slab_slice_words(slab) || slab->end - slab->begin == 1;
}

vxm_status vxm_cl_return_begin(vxm_opencl *engine, vxm_cl_return *back, vxm_error *error) {
  const vxm_cl *cl = engine->cl;
  size_t bytes = back->slab.words * sizeof(uint64_t);
  cl_event made = NULL;
  uint64_t *to = vxm_slab_slice_at(&back->slab, back->slab.window->words, back->slab.begin);
  if (back->is_or || !is_dense(&back->slab)) {
    vxm_status status = VXM_OK;
    to = back->block = vxm_try_alloc(engine->base.context, back->slab.words, sizeof *to, &status, error);
    if (!to)
      return status;
  }
  cl_int code = cl->EnqueueMarkerWithWaitList(engine->queue, 0, NULL, &made);
  if (code == CL_SUCCESS)
    code = cl->EnqueueReadBuffer(engine->transfer, engine->buffers[back->from].mem, CL_FALSE, 0, bytes, to, 1,
                                 &made, &back->event);
  if (made)
    cl->ReleaseEvent(made);
  if (code == CL_SUCCESS)
    code = cl->Flush(engine->queue);
  if (code == CL_SUCCESS)
    code = cl->Flush(engine->transfer);
  return vxm_cl_check(code, "reading voxels", error);
}

vxm_status vxm_cl_return_end(vxm_opencl *engine, vxm_cl_return *back, vxm_status status, vxm_error *error) {
  if (back->event) {
    cl_int code = engine->cl->WaitForEvents(1, &back->event);
    engine->cl->ReleaseEvent(back->event);
    back->event = NULL;
    vxm_status ended = vxm_cl_check(code, "reading voxels", status == VXM_OK ? error : NULL);
    if (ended == VXM_OK && back->block)
      vxm_slab_take(&back->slab, back->slab.window->words, back->block, back->is_or);
    status = status == VXM_OK ? ended : status;
  }
  vxm_free(engine->base.context, back->block);
  back->block = NULL;
  return status;
}
