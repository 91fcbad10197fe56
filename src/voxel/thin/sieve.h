/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Puts aside triangles that meet no link, square or cube without a voxel, many at a time.
 *
 * The surface of a thick body has empty links and squares on its outer side only, so that the plane of a
 * triangle does not come between their corners. Where it does, and the triangle reaches there, the triangle
 * is kept, to be looked at exactly. The test is in floats, with room for rounding: it keeps all that meet
 * something, and a few more.
 */
#ifndef VXM_VOXEL_THIN_SIEVE_H
#define VXM_VOXEL_THIN_SIEVE_H

#include "voxel/thin/thin_job.h"

/** A window and triangles. Along the fast, the middle and the slow axis, in this order. */
typedef struct vxm_sieve {
  const int32_t (*points)[4];
  const uint32_t (*corners)[3];
  const uint64_t *words;
  int32_t last; /**< byte of `words` at which four can be read */
  int bits;     /**< of the lattice */
  int axis[3];
  int32_t begin[3], end[3];
  int32_t step[3]; /**< bits from a voxel to the next one */
} vxm_sieve;

/** Boxes of more cells along an axis are kept: a row of their voxels is to fit 32 bits, from any bit of a
 * byte on. */
enum { VXM_SIEVE_CELLS = 23 };

/** The sieve of a job; false if it has none, as points or the solid are not in its form. */
bool vxm_sieve_of(vxm_sieve *sieve, const vxm_thin_job *job);

#endif
