/* SPDX-License-Identifier: BSD-3-Clause */
/** Points moved and displaced on their way into a grid: variants for training (Ogayar et al., section III-B).
 */
#ifndef VXM_VOXEL_LATTICE_VERTEX_TRANSFORM_H
#define VXM_VOXEL_LATTICE_VERTEX_TRANSFORM_H

#include "base/context.h"

/**
 * A point p becomes matrix (p, 1) + noise, in doubles: the products and sums of a row from left to right,
 * each rounded by itself, so that every processor that follows IEEE 754 finds the same point.
 */
typedef struct vxm_vertex_transform {
  const double (*from)[3];
  size_t count;
  const double *matrix;    /**< 3 x 4, row after row */
  const uint32_t *entry;   /**< of each point, where in the noise its displacement is; NULL = not displaced */
  const float (*noise)[4]; /**< a circular buffer of vectors; the fourth number is 0 */
  uint32_t noise_size;
  uint32_t offset; /**< where it begins; below noise_size */
  double stretch;  /**< at least how many times as long as before any edge becomes, 0 = not told, ... */
  double reach;    /**< ... plus at most so much, in units of the space */
  uint64_t
      from_serial; /**< of points and entries: no two that hold others have the same; 0 = not for engines */
  uint64_t noise_serial;
} vxm_vertex_transform;

/** Moves all points, by the threads of the context. */
void vxm_vertex_transform_apply(vxm_context *context, double (*to)[3], const vxm_vertex_transform *motion);
/** Moves points begin..end-1, to `to` from its beginning on. */
void vxm_vertex_transform_range(double (*to)[3], const vxm_vertex_transform *motion, size_t begin,
                                size_t end);

#endif
