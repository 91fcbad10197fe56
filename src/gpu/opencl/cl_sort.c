/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/opencl/cl_sort.h"

/** As in shaders/sort.cl. */
enum { SCAN_ITEMS = 8, SORT_ROUNDS = 16, DIGIT_BITS = 4, DIGITS = 1 << DIGIT_BITS, LEVELS_MAX = 12 };

static size_t blocks_of(size_t count, size_t block) {
  return (count + block - 1) / block;
}

vxm_status vxm_cl_scan(vxm_opencl *engine, vxm_cl_buffer_id numbers, size_t count, vxm_error *error) {
  cl_uint counts[LEVELS_MAX], at[LEVELS_MAX];
  int levels = 0;
  vxm_status status = vxm_cl_ready(engine, VXM_CL_SORT, error);
  if (status != VXM_OK)
    return status;
  size_t block = engine->group * SCAN_ITEMS, left = count + 1, used = 0;
  if (left > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "opencl: %zu numbers are too many to add up; use --engine cpu",
                    count);
  /* Level 0 lies in `numbers`; the sums of its blocks are level 1, and lie in VXM_CL_SUMS with all others. */
  for (;; left = blocks_of(left, block)) {
    counts[levels] = (cl_uint)left;
    at[levels] = (cl_uint)used;
    used += levels > 0 ? left : 0;
    levels++;
    if (levels > 1 && left == 1)
      break;
  }
  status = vxm_cl_reserve(engine, VXM_CL_SUMS, used * sizeof(cl_uint), error);
  for (int l = 0; l + 1 < levels && status == VXM_OK; l++)
    status = vxm_cl_run_groups(engine, VXM_CL_SCAN_BLOCKS, counts[l + 1],
                               VXM_CL_ARGS(VXM_CL_MEM(engine, l == 0 ? numbers : VXM_CL_SUMS),
                                           VXM_CL_MEM(engine, VXM_CL_SUMS), VXM_CL_VALUE(at[l]),
                                           VXM_CL_VALUE(at[l + 1]), VXM_CL_VALUE(counts[l])),
                               error);
  for (int l = levels - 3; l >= 0 && status == VXM_OK; l--)
    status = vxm_cl_run_groups(engine, VXM_CL_SCAN_ADD, counts[l + 1],
                               VXM_CL_ARGS(VXM_CL_MEM(engine, l == 0 ? numbers : VXM_CL_SUMS),
                                           VXM_CL_MEM(engine, VXM_CL_SUMS), VXM_CL_VALUE(at[l]),
                                           VXM_CL_VALUE(at[l + 1]), VXM_CL_VALUE(counts[l])),
                               error);
  return status;
}

static void swap(vxm_opencl *engine, vxm_cl_buffer_id a, vxm_cl_buffer_id b) {
  vxm_cl_buffer kept = engine->buffers[a];
  engine->buffers[a] = engine->buffers[b];
  engine->buffers[b] = kept;
}

vxm_status vxm_cl_sort(vxm_opencl *engine, vxm_cl_buffer_id keys, vxm_cl_buffer_id values, size_t count,
                       int bits, vxm_error *error) {
  vxm_status status = vxm_cl_ready(engine, VXM_CL_SORT, error);
  size_t groups = status == VXM_OK ? blocks_of(count, engine->group * SORT_ROUNDS) : 0;
  const cl_uint number = (cl_uint)count;
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_SORT_KEYS, count * sizeof(uint64_t), error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_SORT_VALUES, count * sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_DIGITS, (DIGITS * groups + 1) * sizeof(uint32_t), error);
  for (cl_uint shift = 0; (int)shift < bits && count > 1 && status == VXM_OK; shift += DIGIT_BITS) {
    status = vxm_cl_run_groups(engine, VXM_CL_SORT_COUNT, groups,
                               VXM_CL_ARGS(VXM_CL_MEM(engine, keys), VXM_CL_MEM(engine, VXM_CL_DIGITS),
                                           VXM_CL_VALUE(shift), VXM_CL_VALUE(number)),
                               error);
    if (status == VXM_OK)
      status = vxm_cl_scan(engine, VXM_CL_DIGITS, DIGITS * groups, error);
    if (status == VXM_OK)
      status = vxm_cl_run_groups(
          engine, VXM_CL_SORT_SCATTER, groups,
          VXM_CL_ARGS(VXM_CL_MEM(engine, keys), VXM_CL_MEM(engine, values),
                      VXM_CL_MEM(engine, VXM_CL_SORT_KEYS), VXM_CL_MEM(engine, VXM_CL_SORT_VALUES),
                      VXM_CL_MEM(engine, VXM_CL_DIGITS), VXM_CL_VALUE(shift), VXM_CL_VALUE(number)),
          error);
    swap(engine, keys, VXM_CL_SORT_KEYS);
    swap(engine, values, VXM_CL_SORT_VALUES);
  }
  return status;
}
