/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels of groups, counted by OpenCL: shaders/coverage.cl. */
#include "gpu/opencl/cl_solid.h"

/** Counts the groups of a slab, which begins and ends between slices of groups. */
static vxm_status count_slab(vxm_opencl *engine, const vxm_slab *slab, int n, uint16_t *counts,
                             vxm_error *error) {
  const cl_uint groups = (cl_uint)(slab->window->fast_dim / n),
                rows = (cl_uint)(slab->window->middle_dim / n);
  const cl_uint slices = (cl_uint)((slab->end - slab->begin) / n), words = (cl_uint)(2 * slab->row_words);
  const cl_uint4 shape = {{words, rows, groups, 0}};
  const cl_uint all = words * rows * slices, side = (cl_uint)n;
  size_t bytes = (size_t)groups * rows * slices * sizeof *counts;
  vxm_status status = vxm_cl_slab_upload(engine, VXM_CL_RESULT, slab, error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_GROUPS, bytes, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_COUNT_GROUPS, all,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_RESULT), VXM_CL_MEM(engine, VXM_CL_GROUPS),
                                    VXM_CL_VALUE(shape), VXM_CL_VALUE(side), VXM_CL_VALUE(all)),
                        error);
  return status == VXM_OK ? vxm_cl_download(engine, VXM_CL_GROUPS, 0, counts, bytes, error) : status;
}

vxm_status vxm_cl_count(vxm_engine *base, uint16_t *counts, const vxm_window *window, int n,
                        vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  size_t slice = (size_t)(window->fast_dim / n) * (size_t)(window->middle_dim / n);
  int64_t slices = n;
  vxm_status status = vxm_cl_slab_slices(&slices, engine, window, error);
  slices = vxm_max(slices / n, 1) * n;
  for (int64_t k = window->begin; k < window->end && status == VXM_OK; k += slices) {
    vxm_slab slab = vxm_slab_of(window, k, slices);
    status = count_slab(engine, &slab, n, counts + (size_t)((k - window->begin) / n) * slice, error);
    if (status == VXM_OK)
      status =
          vxm_progress(base->context, "counting voxels",
                       (double)(slab.end - window->begin) / (double)(window->end - window->begin), error);
  }
  return status;
}
