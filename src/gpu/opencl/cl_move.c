/* SPDX-License-Identifier: BSD-3-Clause */
/** Variants of a model that stays on the device: a kernel moves its points. */
#include "gpu/opencl/cl_solid.h"

vxm_status vxm_cl_move(vxm_engine *base, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                       vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  const vxm_triangle_set *triangles = job->triangles;
  vxm_device_transform_job cl_job = vxm_device_transform_job_of(placed, job->motion);
  if (engine->base.info.moves)
    engine->base.info.moves = vxm_cl_ready(engine, VXM_CL_MOVE, NULL) == VXM_OK;
  if (!engine->base.info.moves ||
      !vxm_device_cache_motion(&engine->device_cache, job->motion, triangles->point_count))
    return VXM_OK;
  vxm_status status = vxm_cl_run(
      engine, VXM_CL_MOVE_POINTS, triangles->first_apex,
      VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_ORIGINALS), VXM_CL_MEM(engine, VXM_CL_ENTRIES),
                  VXM_CL_MEM(engine, VXM_CL_NOISE), VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_VALUE(cl_job)),
      error);
  if (status == VXM_OK)
    status = vxm_cl_download(engine, VXM_CL_POINTS, 0, placed->narrow,
                             triangles->first_apex * sizeof *placed->narrow, error);
  return status == VXM_OK ? vxm_device_cache_moved(&engine->device_cache, placed, job, done, error) : status;
}
