/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/engine/device_voxels.h"
#include "base/context.h"
#include "base/dlpack.h"

size_t vxm_voxel_format_bytes(vxm_voxel_format format) {
  return format == VXM_VOXEL_FORMAT_UINT8 ? 1 : format == VXM_VOXEL_FORMAT_FLOAT32 ? sizeof(float) : 0;
}

void vxm_device_voxels_drop(vxm_device_voxels *voxels) {
  if (!voxels || atomic_fetch_sub_explicit(&voxels->reference_count, 1, memory_order_acq_rel) != 1)
    return;
  vxm_context *context = voxels->context;
  voxels->release(voxels);
  vxm_memory_give(context, voxels->bytes);
  vxm_free(context, voxels);
  vxm_context_release(context);
}

/* ---- DLPack ---- */

enum { DIMS_MAX = 4 };

typedef struct shared {
  struct DLManagedTensor managed; /**< first, so that it is one */
  int64_t shape[DIMS_MAX], strides[DIMS_MAX];
} shared;

static void delete_shared(struct DLManagedTensor *managed) {
  vxm_device_voxels *voxels = managed->owner;
  vxm_free(voxels->context, managed);
  vxm_device_voxels_drop(voxels);
}

vxm_status vxm_device_voxels_share(struct DLManagedTensor **out, vxm_device_voxels *voxels,
                                   vxm_error *error) {
  const vxm_device_info *info = &voxels->info;
  vxm_status status = VXM_OK;
  shared *made = vxm_try_calloc(voxels->context, 1, sizeof *made, &status, error);
  if (!made)
    return status;
  bool is_packed = info->format == VXM_VOXEL_FORMAT_PACKED;
  int64_t element = is_packed ? 1 : (int64_t)vxm_voxel_format_bytes(info->format);
  made->shape[0] = info->count;
  made->shape[1] = info->dims[0];
  made->shape[2] = info->dims[1];
  made->shape[3] = is_packed ? (info->dims[2] + 7) / 8 : info->dims[2];
  for (int a = 0; a < 3; a++)
    made->strides[a] = info->step[a] / element;
  made->strides[3] = 1;
  int first = voxels->is_batch ? 0 : 1;
  made->managed = (struct DLManagedTensor){.tensor = {.data = info->buffer,
                                                      .device_kind = VXM_DLPACK_OPENCL,
                                                      .device_number = info->device,
                                                      .dims = DIMS_MAX - first,
                                                      .element_kind = info->format == VXM_VOXEL_FORMAT_FLOAT32
                                                                          ? VXM_DLPACK_FLOAT
                                                                          : VXM_DLPACK_UINT,
                                                      .element_bits = (uint8_t)(8 * element),
                                                      .lanes = 1,
                                                      .shape = made->shape + first,
                                                      .strides = made->strides + first},
                                           .owner = voxels,
                                           .deleter = delete_shared};
  atomic_fetch_add_explicit(&voxels->reference_count, 1, memory_order_relaxed);
  *out = &made->managed;
  return VXM_OK;
}
