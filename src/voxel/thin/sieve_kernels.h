/* SPDX-License-Identifier: BSD-3-Clause */
/** The inner loops of the sieve, built for several processors from one source (sieve_kernels_body.inc). All
 * builds keep the same triangles. */
#ifndef VXM_VOXEL_THIN_SIEVE_KERNELS_H
#define VXM_VOXEL_THIN_SIEVE_KERNELS_H

#include "voxel/parity/kernels.h"
#include "voxel/thin/sieve.h"

typedef struct vxm_sieve_kernels {
  /** The triangles begin..end-1 that may meet something without a voxel; there is room for eight more.
   * Returns how many. */
  size_t (*sift)(const vxm_sieve *sieve, uint32_t *kept, size_t begin, size_t end);
  /** to[i] = from[i] | from[i - step] for all `count` words that are there; or, if step is 0, | the bit
   * before each. */
  void (*join)(uint64_t *to, const uint64_t *from, size_t step, size_t count);
} vxm_sieve_kernels;

/** The build that goes with other kernels; NULL = with those of vxm_kernels_get. */
const vxm_sieve_kernels *vxm_sieve_kernels_of(const vxm_kernels *kernels);

#endif
