/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels that stay on a device: what all engines that keep some have in common. */
#ifndef VXM_VOXEL_ENGINE_DEVICE_VOXELS_H
#define VXM_VOXEL_ENGINE_DEVICE_VOXELS_H

#include "grid/window.h"
#include "voxmend/experimental.h"

#include <stdatomic.h>

struct vxm_device_voxels {
  vxm_device_info info;
  vxm_context *context;       /**< one reference held */
  size_t bytes;               /**< counted against its memory limit */
  atomic_int reference_count; /**< held by the caller and by tensors */
  vxm_layout layout;          /**< of the windows that become voxels */
  bool is_batch;              /**< a tensor of them has variants first */
  /** Frees what is on the device; set by the engine. */
  void (*release)(vxm_device_voxels *voxels);
};

/** One reference fewer; with the last one the voxels are destroyed. NULL is allowed. */
void vxm_device_voxels_drop(vxm_device_voxels *voxels);

/** See vxm_device_voxels_dlpack in voxmend/experimental.h; of a buffer. */
vxm_status vxm_device_voxels_share(struct DLManagedTensor **out, vxm_device_voxels *voxels, vxm_error *error);

/** Bytes of a voxel; 0 = a bit. */
size_t vxm_voxel_format_bytes(vxm_voxel_format format);

#endif
