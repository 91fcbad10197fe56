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
  int32_t step[3];                /**< bytes from a row to the next one, along the middle and the slow axis */
  const uint64_t *middles[8];     /**< as in vxm_thin_job */
  const uint64_t *cells;          /**< of the points; and along x, y, z: */
  uint64_t first_cell, last_cell; /**< around which all voxels are in the window */
  uint64_t cell_step[3], origin;  /**< from the number of a cell to the bit of the voxel behind it */
} vxm_sieve;

/** Boxes of more cells along an axis are kept: a row of their voxels is to fit 32 bits, from any bit of a
 * byte on. */
enum { VXM_SIEVE_CELLS = 23 };

/** The lowest bit of each of the numbers of a cell. */
#define VXM_SIEVE_ONES (UINT64_C(1) | UINT64_C(1) << VXM_CELL_BITS | UINT64_C(1) << 2 * VXM_CELL_BITS)

/** The sieve of a job; false if it has none, as points or the solid are not in its form. */
bool vxm_sieve_of(vxm_sieve *sieve, const vxm_thin_job *job);

/** Fills the maps of vxm_thin_job of a window, without padding between slices; middles[7] are its own words.
 * The first voxels along an axis have no others before them, and no bits that mean something. */
void vxm_middles_fill(uint64_t *const middles[8], const vxm_window *window);

#endif
