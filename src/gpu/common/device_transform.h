/* SPDX-License-Identifier: BSD-3-Clause */
/** Points that a device moves and places for variants: what its shaders are told, and whether they
 * found what the CPU finds. */
#ifndef VXM_GPU_COMMON_DEVICE_TRANSFORM_H
#define VXM_GPU_COMMON_DEVICE_TRANSFORM_H

#include "voxel/engine/engine.h"

/** The uniform block of shaders/move.vert, and the argument of shaders/move.cl. */
typedef struct vxm_device_transform_job {
  double row[3][4];       /**< of the matrix */
  double origin[4];       /**< of the space; the fourth number is not used */
  double scale[4];        /**< steps per unit; the fourth number is what all of them stay below */
  uint32_t size, offset;  /**< of the noise; 0 = not displaced */
  uint32_t count, unused; /**< points */
} vxm_device_transform_job;

vxm_device_transform_job vxm_device_transform_job_of(const vxm_snapped_points *placed,
                                                     const vxm_vertex_transform *motion);

enum { VXM_MOVED_TRIED = 512 };

/** Whether the device rounds as IEEE 754 has it: up to VXM_MOVED_TRIED of its points are where the CPU finds
 * them. */
bool vxm_device_transform_alike(const vxm_snapped_points *placed, const vxm_vertex_transform *motion);

#endif
