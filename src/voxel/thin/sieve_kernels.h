/* SPDX-License-Identifier: BSD-3-Clause */
/** The inner loops of the sieve, built for several processors from one source (sieve_kernels_body.inc). All
 * builds keep the same triangles. */
#ifndef VXM_VOXEL_THIN_SIEVE_KERNELS_H
#define VXM_VOXEL_THIN_SIEVE_KERNELS_H

#include "voxel/parity/kernels.h"
#include "voxel/thin/octree_sieve.h"
#include "voxel/thin/sieve.h"

typedef struct vxm_sieve_kernels {
  /** Of the triangles from *begin on, to `end` - 1 at most, or those of the sieve's order, the ones that may
   * meet something without a voxel: *begin becomes the first that was not looked at. There is room for
   * VXM_SIEVE_BATCH + 16. Returns how many. */
  size_t (*sift)(const vxm_sieve *sieve, uint32_t *kept, size_t *begin, size_t end);
  /** to[i] = from[i] | from[i - step], if that is there, for all `count` words. */
  void (*join)(uint64_t *to, const uint64_t *from, size_t step, size_t count);
  /** Short numbers of cells, as vxm_thin_job has them. @param axis the fast, the middle and the slow one */
  void (*shorten)(uint32_t *to, const uint64_t *cells, size_t count, const int axis[3]);
  /** Whether links that a triangle crosses may have no voxel at their ends, if the solid is on one side of
   * it, 1 for that to which the normal points, else -1. @param unsure NULL, or becomes such links: they are
   * boxes, and empty ones lie from INT64_MAX to INT64_MIN */
  bool (*search_bricks)(const vxm_octree_sieve *sieve, int inner, vxm_unsure_links *unsure);
} vxm_sieve_kernels;

/** The build that goes with other kernels; NULL = with those of vxm_kernels_get. */
const vxm_sieve_kernels *vxm_sieve_kernels_of(const vxm_kernels *kernels);

#endif
