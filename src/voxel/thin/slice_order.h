/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles in the order of the slices in which they lie. */
#ifndef VXM_VOXEL_THIN_SLICE_ORDER_H
#define VXM_VOXEL_THIN_SLICE_ORDER_H

#include "base/context.h"
#include "voxel/thin/thin_job.h"

/** Memory that is kept from one use to the next. Start from {.context = ...}. */
typedef struct vxm_slice_order {
  vxm_context *context;
  uint32_t *triangles; /**< by number */
  size_t capacity;     /**< of `triangles` */
  size_t count;
} vxm_slice_order;

/**
 * Orders the triangles that reach into the slices of a job's view, so that what is read of a large window for
 * one of them is still in the cache for the next. The points' cells must be known.
 *
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_slice_order_make(vxm_slice_order *order, const vxm_thin_job *job, vxm_error *error);

void vxm_slice_order_destroy(vxm_slice_order *order);

#endif
