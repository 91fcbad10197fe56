/* SPDX-License-Identifier: BSD-3-Clause */
/** Surfaces by OpenCL: shaders/surface.cl tells exactly which voxels belong to a triangle. */
#include "gpu/opencl/cl_solid.h"

enum { FEW_COLUMNS = 64 /**< of a triangle that one work-item does */ };

typedef struct surface_job {
  const vxm_surface *surface;
  vxm_surface_kind kind;
  bool is_fresh;
} surface_job;

static vxm_status set_slab(vxm_engine *base, const vxm_slab *slab, int to, void *payload, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  const vxm_cl_buffer_id into = (vxm_cl_buffer_id)to;
  const surface_job *s = payload;
  vxm_slab_surface job = vxm_slab_surface_of(slab, s->surface, s->kind);
  job.few_columns = FEW_COLUMNS;
  vxm_status status = base->keeps && !s->is_fresh
                          ? vxm_cl_slab_bring(engine, slab, into, error)
                          : vxm_cl_clear(engine, into, slab->words * sizeof(uint64_t), error);
  if (status == VXM_OK)
    status = vxm_cl_clear_large(engine, job.triangle_count, error);
  const vxm_cl_arg args[] = {VXM_CL_MEM(engine, VXM_CL_SURFACE_POINTS),
                             VXM_CL_MEM(engine, VXM_CL_SURFACE_CORNERS), VXM_CL_MEM(engine, into),
                             VXM_CL_MEM(engine, VXM_CL_LARGE), VXM_CL_VALUE(job)};
  const size_t count = sizeof args / sizeof args[0];
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_SET_SURFACE, job.triangle_count, args, count, error);
  if (status == VXM_OK)
    status = vxm_cl_run_groups(engine, VXM_CL_SET_LARGE, vxm_cl_busy_groups(engine), args, count, error);
  return status == VXM_OK ? vxm_progress(engine->base.context, "voxelizing the surface", 1, error) : status;
}

vxm_status vxm_cl_surface(vxm_engine *base, const vxm_surface *surface, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_status status = vxm_device_cache_surface(&engine->device_cache, surface, error);
  if (status == VXM_OK && base->keeps && engine->device_cache.oversized_surface.count > 0)
    return vxm_fail_to_keep(base, error);
  if (status == VXM_OK)
    status =
        vxm_cl_each_slab(base, window, !is_fresh, set_slab, &(surface_job){surface, kind, is_fresh}, error);
  return status == VXM_OK && !base->keeps ? vxm_oversized_surface_add(&engine->device_cache.oversized_surface,
                                                                      surface, window, kind, error)
                                          : status;
}
