/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels that stay in a buffer of the device: shaders/device_voxels.cl. */
#include "gpu/opencl/cl_solid.h"

/** It holds the driver's objects, not the engine: any thread may drop it. */
typedef struct cl_voxels {
  vxm_device_voxels base; /**< first, so that it is one */
  const vxm_cl *cl;
} cl_voxels;

static void release(vxm_device_voxels *voxels) {
  const vxm_cl *cl = ((cl_voxels *)voxels)->cl;
  const vxm_device_info *info = &voxels->info;
  if (info->buffer)
    cl->ReleaseMemObject(info->buffer);
  cl->ReleaseCommandQueue(info->queue);
  cl->ReleaseContext(info->context);
}

/** Rows run along z, those of bits in whole words. */
static vxm_status set_steps(vxm_device_info *info, const vxm_opencl *engine, vxm_error *error) {
  int64_t element = (int64_t)vxm_voxel_format_bytes(info->format), row, most;
  row = element > 0 ? info->dims[2] * element : (info->dims[2] + 63) / 64 * (int64_t)sizeof(uint64_t);
  most = engine->base.info.block_bytes;
  info->step[2] = row;
  if (__builtin_mul_overflow(info->dims[1], row, &info->step[1]) ||
      __builtin_mul_overflow(info->dims[0], info->step[1], &info->step[0]) ||
      __builtin_mul_overflow(info->count, info->step[0], &info->bytes) || info->bytes > most)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "the voxels take more than the %lld bytes that %s gives to a buffer", (long long)most,
                    engine->base.info.renderer);
  return VXM_OK;
}

static vxm_status make_buffer(vxm_opencl *engine, vxm_device_voxels *made, vxm_error *error) {
  cl_int code;
  size_t bytes = (size_t)made->info.bytes;
  vxm_status status = vxm_memory_take(made->context, bytes, error);
  if (status != VXM_OK)
    return status;
  made->bytes = bytes;
  made->info.buffer = engine->cl->CreateBuffer(engine->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
  return vxm_cl_check(code, "making a buffer", error);
}

vxm_status vxm_cl_device_voxels(vxm_engine *base, vxm_device_voxels **out, const vxm_device_info *shape,
                                vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_device_info info = *shape;
  info.kind = VXM_DEVICE_OPENCL;
  info.device = engine->number;
  info.context = engine->context;
  info.queue = engine->queue;
  info.device_id = engine->device.id;
  vxm_status status = set_steps(&info, engine, error);
  if (status != VXM_OK)
    return status;
  cl_voxels *made = vxm_try_calloc(base->context, 1, sizeof *made, &status, error);
  if (!made)
    return status;
  status = vxm_context_acquire(&made->base.context, base->context, error);
  made->base.info = info;
  made->base.layout = (vxm_layout){2, 1, 0};
  made->base.release = release;
  made->cl = engine->cl;
  atomic_init(&made->base.reference_count, 1);
  engine->cl->RetainContext(engine->context);
  engine->cl->RetainCommandQueue(engine->queue);
  if (status == VXM_OK)
    status = make_buffer(engine, &made->base, error);
  if (status == VXM_OK)
    *out = &made->base;
  else
    vxm_device_voxels_drop(&made->base);
  return status;
}

/* ---- A window that stays ---- */

vxm_status vxm_cl_device_voxels_begin(vxm_engine *base, const vxm_window *window, vxm_error *error) {
  return vxm_cl_clear(vxm_opencl_of(base), VXM_CL_STAYING, vxm_window_bytes(window), error);
}

static vxm_status copy(vxm_opencl *engine, vxm_cl_buffer_id from, size_t from_at, vxm_cl_buffer_id to,
                       size_t to_at, size_t bytes, vxm_error *error) {
  return vxm_cl_check(engine->cl->EnqueueCopyBuffer(engine->queue, engine->buffers[from].mem,
                                                    engine->buffers[to].mem, from_at, to_at, bytes, 0, NULL,
                                                    NULL),
                      "copying a buffer", error);
}

vxm_status vxm_cl_slab_stay(vxm_opencl *engine, const vxm_slab *slab, vxm_cl_buffer_id from,
                            vxm_error *error) {
  return copy(engine, from, 0, VXM_CL_STAYING, vxm_slab_offset(slab), slab->words * sizeof(uint64_t), error);
}

vxm_status vxm_cl_slab_bring(vxm_opencl *engine, const vxm_slab *slab, vxm_cl_buffer_id to,
                             vxm_error *error) {
  size_t bytes = slab->words * sizeof(uint64_t);
  vxm_status status = vxm_cl_reserve(engine, to, bytes, error);
  return status == VXM_OK ? copy(engine, VXM_CL_STAYING, vxm_slab_offset(slab), to, 0, bytes, error) : status;
}

/** From bits to elements, or as they are. */
static vxm_status take(vxm_opencl *engine, const vxm_device_info *info, int64_t index,
                       const vxm_window *window, vxm_error *error) {
  size_t bytes = vxm_window_bytes(window), element = vxm_voxel_format_bytes(info->format);
  size_t at = (size_t)index * (size_t)info->step[0];
  cl_mem to = info->buffer;
  if (element == 0)
    return vxm_cl_check(engine->cl->EnqueueCopyBuffer(engine->queue, engine->buffers[VXM_CL_STAYING].mem, to,
                                                      0, at, bytes, 0, NULL, NULL),
                        "copying a buffer", error);
  const cl_uint2 shape = {{(cl_uint)(2 * window->row_words), (cl_uint)window->fast_dim}};
  const cl_ulong first = at / element, words = bytes / sizeof(cl_uint);
  vxm_status status = vxm_cl_ready(engine, VXM_CL_DEVICE_VOXELS, error);
  return status == VXM_OK
             ? vxm_cl_run(engine, element == 1 ? VXM_CL_DEVICE_VOXELS_BYTES : VXM_CL_DEVICE_VOXELS_FLOATS,
                          words,
                          VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_STAYING), VXM_CL_VALUE(to),
                                      VXM_CL_VALUE(shape), VXM_CL_VALUE(first), VXM_CL_VALUE(words)),
                          error)
             : status;
}

vxm_status vxm_cl_device_voxels_end(vxm_engine *base, vxm_device_voxels *voxels, int64_t index,
                                    const vxm_window *window, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_status status = VXM_OK;
  if (window->words)
    status = vxm_cl_upload(engine, VXM_CL_STAYING, window->words, vxm_window_bytes(window), error);
  if (status == VXM_OK)
    status = take(engine, &voxels->info, index, window, error);
  return status == VXM_OK ? vxm_cl_check(engine->cl->Finish(engine->queue), "keeping voxels", error) : status;
}
