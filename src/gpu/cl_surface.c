/* SPDX-License-Identifier: BSD-3-Clause */
/** Surfaces by OpenCL: shaders/surface.cl tells exactly which voxels belong to a triangle. */
#include "gpu/cl_solid.h"

enum { FEW_COLUMNS = 64 /**< of a triangle that one work-item does */ };

static vxm_status set_tile(vxm_opencl *engine, const vxm_surface *surface, const vxm_tile *tile,
                           vxm_surface_kind kind, vxm_cl_buffer_id into, vxm_error *error) {
  vxm_tile_surface job = vxm_tile_surface_of(tile, surface, kind);
  job.few_columns = FEW_COLUMNS;
  vxm_status status = vxm_cl_clear(engine, into, tile->words * sizeof(uint64_t), error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_LARGE, (1 + (size_t)job.facet_count) * sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_LARGE, sizeof(uint32_t), error);
  const vxm_cl_arg args[] = {VXM_CL_MEM(engine, VXM_CL_SURFACE_POINTS),
                             VXM_CL_MEM(engine, VXM_CL_SURFACE_CORNERS), VXM_CL_MEM(engine, into),
                             VXM_CL_MEM(engine, VXM_CL_LARGE), VXM_CL_VALUE(job)};
  const size_t count = sizeof args / sizeof args[0];
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_SET_SURFACE, job.facet_count, args, count, error);
  if (status == VXM_OK)
    status = vxm_cl_run_groups(engine, VXM_CL_SET_LARGE, vxm_cl_busy_groups(engine), args, count, error);
  return status == VXM_OK ? vxm_progress(engine->base.context, "voxelizing the surface",
                                         (double)(tile->end - tile->window->begin) /
                                             (double)(tile->window->end - tile->window->begin),
                                         error)
                          : status;
}

static vxm_status set_tiles(vxm_opencl *engine, const vxm_surface *surface, const vxm_window *window,
                            vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  vxm_cl_return back[2] = {{.from = VXM_CL_RESULT}, {.from = VXM_CL_RESULT2}};
  int64_t slices = 1;
  int which = 0;
  vxm_status status = vxm_cl_tile_slices(&slices, engine, window, error);
  for (int64_t k = window->begin; k < window->end && status == VXM_OK; k += slices, which ^= 1) {
    vxm_tile tile = vxm_tile_of(window, k, slices);
    status = vxm_cl_return_end(engine, &back[which], status, error);
    if (status == VXM_OK)
      status = set_tile(engine, surface, &tile, kind, back[which].from, error);
    back[which].tile = tile;
    back[which].words = window->words;
    back[which].is_or = !is_fresh;
    if (status == VXM_OK)
      status = vxm_cl_return_begin(engine, &back[which], error);
  }
  return vxm_cl_finish(engine, back, status, error);
}

vxm_status vxm_cl_surface(vxm_engine *base, const vxm_surface *surface, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  vxm_status status = vxm_cl_place_surface(engine, surface, error);
  if (status == VXM_OK)
    status = set_tiles(engine, surface, window, kind, is_fresh, error);
  return status == VXM_OK ? vxm_far_surface_add(&engine->far_surface, surface, window, kind, error) : status;
}
