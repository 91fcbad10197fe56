/* SPDX-License-Identifier: BSD-3-Clause */
/** Points that a device moves and places for variants: what its shaders are told, and whether they
 * found what the CPU finds. */
#ifndef VXM_GPU_MOVED_H
#define VXM_GPU_MOVED_H

#include "voxel/engine.h"

/** The uniform block of shaders/move.vert, and the argument of shaders/move.cl. */
typedef struct vxm_moved_job {
  double row[3][4];       /**< of the matrix */
  double origin[4];       /**< of the space; the fourth number is not used */
  double scale[4];        /**< steps per unit; the fourth number is what all of them stay below */
  uint32_t size, offset;  /**< of the noise; 0 = not displaced */
  uint32_t count, unused; /**< points */
} vxm_moved_job;

vxm_moved_job vxm_moved_job_of(const vxm_placed *placed, const vxm_motion *motion);

enum { VXM_MOVED_TRIED = 512 };

/** Whether the device rounds as IEEE 754 has it: up to VXM_MOVED_TRIED of its points are where the CPU finds
 * them. */
bool vxm_moved_alike(const vxm_placed *placed, const vxm_motion *motion);

#endif
