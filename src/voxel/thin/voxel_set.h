/* SPDX-License-Identifier: BSD-3-Clause */
/** A set of few voxels of a large space: a hash table of their numbers. */
#ifndef VXM_VOXEL_THIN_VOXEL_SET_H
#define VXM_VOXEL_THIN_VOXEL_SET_H

#include "base/context.h"

/** Start from {.context = ...}. */
typedef struct vxm_voxel_set {
  vxm_context *context;
  uint64_t *slots; /**< numbers plus 1; 0 = free */
  size_t size;     /**< of `slots`: 0 or a power of two */
  size_t count;
} vxm_voxel_set;

bool vxm_voxel_set_has(const vxm_voxel_set *set, uint64_t voxel);
/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_voxel_set_add(vxm_voxel_set *set, uint64_t voxel, vxm_error *error);
void vxm_voxel_set_destroy(vxm_voxel_set *set);

#endif
