/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl/opencl.h"
#include "gpu/opencl/cl_solid.h"

enum { GROUP_MOST = 64 };

static void destroy(vxm_engine *base) {
  vxm_opencl *engine = vxm_opencl_of(base);
  const vxm_cl *cl = engine->cl;
  if (engine->queue)
    cl->Finish(engine->queue);
  if (engine->transfer)
    cl->Finish(engine->transfer);
  for (int b = 0; b < VXM_CL_BUFFERS; b++)
    vxm_cl_release(engine, (vxm_cl_buffer_id)b);
  vxm_cl_programs_release(engine);
  if (engine->queue)
    cl->ReleaseCommandQueue(engine->queue);
  if (engine->transfer)
    cl->ReleaseCommandQueue(engine->transfer);
  if (engine->context)
    cl->ReleaseContext(engine->context);
  vxm_cl_device_release(&engine->device, cl);
  vxm_device_cache_destroy(&engine->device_cache);
}

static const vxm_engine_ops opencl_ops = {.move = vxm_cl_move,
                                          .unite = vxm_cl_unite,
                                          .vote = vxm_cl_vote,
                                          .surface = vxm_cl_surface,
                                          .sparse = vxm_cl_sparse,
                                          .sparse_surface = vxm_cl_surface_sparse,
                                          .count = vxm_cl_count,
                                          .device_voxels = vxm_cl_device_voxels,
                                          .device_voxels_begin = vxm_cl_device_voxels_begin,
                                          .device_voxels_end = vxm_cl_device_voxels_end,
                                          .destroy = destroy};

static vxm_status start(vxm_opencl *engine, vxm_error *error) {
  const vxm_cl *cl = engine->cl;
  const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                              (cl_context_properties)engine->device.platform, 0};
  vxm_engine_info *info = &engine->base.info;
  cl_int code;
  if (!info->available)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s: %s", info->renderer, info->note);
  engine->context = cl->CreateContext(properties, 1, &engine->device.id, NULL, NULL, &code);
  if (code == CL_SUCCESS)
    engine->queue = cl->CreateCommandQueue(engine->context, engine->device.id, 0, &code);
  if (code == CL_SUCCESS)
    engine->transfer = cl->CreateCommandQueue(engine->context, engine->device.id, 0, &code);
  if (code != CL_SUCCESS)
    return vxm_cl_check(code, "making a context", error);
  engine->group = 1;
  while (2 * engine->group <= GROUP_MOST && 2 * (int64_t)engine->group <= info->work_group)
    engine->group *= 2;
  if (engine->group < VXM_CL_GROUP_LEAST)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "%s runs groups of %lld work-items only; %d are needed",
                    info->renderer, (long long)info->work_group, VXM_CL_GROUP_LEAST);
  return VXM_OK;
}

vxm_status vxm_opencl_create(vxm_engine **out, vxm_context *context, const vxm_cl *cl,
                             const vxm_cl_device *device, int number, const vxm_engine_options *options,
                             vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_opencl *engine = vxm_try_calloc(context, 1, sizeof *engine, &status, error);
  *out = NULL;
  if (!engine) {
    vxm_cl_device_release(device, cl);
    return status;
  }
  engine->base.ops = &opencl_ops;
  engine->base.context = context;
  engine->device_cache =
      vxm_device_cache_of(&engine->base, vxm_cl_device_cache_upload, vxm_cl_device_cache_release);
  engine->options = *options;
  engine->options.device = NULL; /* the caller's */
  engine->cl = cl;
  engine->device = *device;
  engine->number = number;
  vxm_cl_device_describe(&engine->base.info, cl, device, number);
  status = start(engine, error);
  if (status != VXM_OK) {
    destroy(&engine->base);
    vxm_free(context, engine);
    return status;
  }
  *out = &engine->base;
  return VXM_OK;
}
