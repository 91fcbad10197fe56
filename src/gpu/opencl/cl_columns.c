/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids triangle by triangle (Schwarz & Seidel 2010, section 4.1): shaders/columns.cl flips a bit in each
 * column that a triangle covers, shaders/fold.cl makes voxels of flips. */
#include "gpu/opencl/cl_solid.h"

enum { FEW_COLUMNS = 256 /**< of a triangle that one work-item does */ };

vxm_status vxm_cl_clear_large(vxm_opencl *engine, size_t triangles, vxm_error *error) {
  vxm_status status = vxm_cl_reserve(engine, VXM_CL_LARGE, (1 + triangles) * sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_LARGE, sizeof(uint32_t), error);
  /* An argument has to be a buffer, also where triangles are not looked up. */
  return status == VXM_OK ? vxm_cl_reserve(engine, VXM_CL_ORDER, sizeof(uint32_t), error) : status;
}

static vxm_status flip(vxm_opencl *engine, const vxm_slab_columns *columns, vxm_error *error) {
  vxm_status status = vxm_cl_clear_large(engine, columns->triangle_count, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_FLIP_COLUMNS, columns->triangle_count,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_MEM(engine, VXM_CL_CORNERS),
                                    VXM_CL_MEM(engine, VXM_CL_ORDER), VXM_CL_MEM(engine, VXM_CL_FLIPS),
                                    VXM_CL_MEM(engine, VXM_CL_LARGE), VXM_CL_VALUE(*columns)),
                        error);
  if (status == VXM_OK)
    status =
        vxm_cl_run_groups(engine, VXM_CL_FLIP_LARGE, vxm_cl_busy_groups(engine),
                          VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_MEM(engine, VXM_CL_CORNERS),
                                      VXM_CL_MEM(engine, VXM_CL_FLIPS), VXM_CL_MEM(engine, VXM_CL_LARGE),
                                      VXM_CL_VALUE(*columns)),
                          error);
  return status;
}

static vxm_status flip_far(vxm_opencl *engine, const vxm_slab_columns *columns,
                           const vxm_parity_union_job *job, const vxm_disjoint_passes *passes, size_t pass,
                           vxm_error *error) {
  uint32_t *bits = NULL;
  size_t found = 0;
  if (engine->device_cache.oversized.count == 0)
    return VXM_OK;
  vxm_status status =
      vxm_oversized_flips(&bits, &found, &engine->device_cache.oversized, columns, job, passes, pass, error);
  uint32_t count = (uint32_t)found;
  if (status == VXM_OK && count > 0)
    status = vxm_cl_upload(engine, VXM_CL_LARGE, bits, found * sizeof *bits, error);
  if (status == VXM_OK && count > 0)
    status = vxm_cl_run(
        engine, VXM_CL_FLIP_BITS, count,
        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_FLIPS), VXM_CL_MEM(engine, VXM_CL_LARGE), VXM_CL_VALUE(count)),
        error);
  vxm_free(engine->base.context, bits);
  return status;
}

/** Notes which parts of a pass have flips. */
static vxm_status touch(vxm_opencl *engine, const vxm_slab *slab, const vxm_disjoint_passes *passes,
                        size_t pass, vxm_error *error) {
  size_t first = pass > 0 ? passes->box_end[pass - 1] : 0, count = passes->box_end[pass] - first;
  const cl_uint4 range = {{(cl_uint)first, (cl_uint)count, (cl_uint)slab->begin, (cl_uint)slab->end}};
  const cl_uint rows = (cl_uint)slab->window->middle_dim;
  return vxm_cl_run_groups(engine, VXM_CL_TOUCH, count,
                           VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_FLIPS), VXM_CL_MEM(engine, VXM_CL_BOXES),
                                       VXM_CL_MEM(engine, VXM_CL_TOUCHED), VXM_CL_VALUE(range),
                                       VXM_CL_VALUE(rows)),
                           error);
}

static vxm_status fold(vxm_opencl *engine, const vxm_slab *slab, int axis, vxm_cl_buffer_id into, bool add,
                       vxm_error *error) {
  const vxm_window *window = slab->window;
  cl_uint words = (cl_uint)(2 * slab->row_words), rows = (cl_uint)window->middle_dim, is_added = add;
  cl_uint slices = (cl_uint)(slab->end - slab->begin), used = (cl_uint)((window->fast_dim + 31) / 32);
  if (axis == window->layout.fast) {
    cl_uint tail = window->fast_dim % 32 ? (UINT32_C(1) << (window->fast_dim % 32)) - 1 : UINT32_MAX;
    const cl_uint4 shape = {{rows * slices, words, used, tail}};
    return vxm_cl_run(engine, VXM_CL_FOLD_ROWS, (uint64_t)rows * slices,
                      VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_FLIPS), VXM_CL_MEM(engine, into),
                                  VXM_CL_VALUE(shape), VXM_CL_VALUE(is_added)),
                      error);
  }
  bool middle = axis == window->layout.middle;
  cl_uint side = middle ? words : words * rows, lines = middle ? words * slices : side;
  const cl_uint4 shape = {{lines, side, words * rows, 0}};
  const cl_uint2 line = {{middle ? rows : slices, side}};
  return vxm_cl_run(engine, VXM_CL_FOLD_ACROSS, lines,
                    VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_FLIPS), VXM_CL_MEM(engine, into),
                                VXM_CL_VALUE(shape), VXM_CL_VALUE(line), VXM_CL_VALUE(is_added)),
                    error);
}

vxm_status vxm_cl_columns(vxm_opencl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                          const vxm_disjoint_passes *passes, vxm_cl_buffer_id into, vxm_error *error) {
  vxm_slab_columns columns = vxm_slab_columns_of(slab, job);
  size_t bytes = slab->words * sizeof(uint64_t), begin = 0;
  columns.few_columns = FEW_COLUMNS;
  columns.ordered = passes->ordered;
  vxm_status status = vxm_cl_reserve_flips(engine, bytes, error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, into, bytes, error);
  for (size_t p = 0; p < passes->count && status == VXM_OK; p++) {
    columns.triangle_first = (uint32_t)(passes->ordered ? begin : passes->first);
    columns.triangle_count = (uint32_t)(passes->triangle_end[p] - begin);
    begin = passes->triangle_end[p];
    if (columns.triangle_count > 0)
      status = flip(engine, &columns, error);
    if (status == VXM_OK)
      status = flip_far(engine, &columns, job, passes, p, error);
    if (status == VXM_OK && job->has_voxels)
      status = touch(engine, slab, passes, p, error);
    if (status == VXM_OK)
      status = fold(engine, slab, job->axis, into, p > 0, error);
    if (status == VXM_OK)
      status = vxm_progress(engine->base.context, job->phase, (double)(p + 1) / (double)passes->count, error);
  }
  return status;
}
