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
  const uint32_t *order; /**< of the triangles, by number; NULL = as they are */
  const uint64_t *words;
  int32_t last; /**< byte of `words` at which four can be read */
  int bits;     /**< of the lattice */
  int axis[3];
  int32_t begin[3], end[3];
  int32_t step[3];             /**< bytes from a row to the next one, along the middle and the slow axis */
  const uint64_t *cells;       /**< of the points */
  const uint32_t *short_cells; /**< as in vxm_thin_job */
  const uint64_t *middles;     /**< as in vxm_thin_job */
  uint32_t map_bits;           /**< from a map to the next one */
  uint32_t short_first, short_last; /**< cells that have a voxel in the window, if there are maps */
  uint32_t row_bits, slice_bits;    /**< from a row and a slice to the next one */
  uint32_t short_origin;            /**< from the cell before all voxels to the bit of the voxel behind it */
} vxm_sieve;

/** Boxes of more cells along an axis are kept: a row of their voxels is to fit 32 bits, from any bit of a
 * byte on. */
enum { VXM_SIEVE_CELLS = 23 };

/** Triangles that are looked at together at most. */
enum { VXM_SIEVE_BATCH = 2048 };

/** The lowest bit of each of the numbers of a cell. */
#define VXM_SIEVE_ONES (UINT64_C(1) | UINT64_C(1) << VXM_CELL_BITS | UINT64_C(1) << 2 * VXM_CELL_BITS)
#define VXM_SHORT_ONES (UINT32_C(1) | UINT32_C(1) << VXM_SHORT_BITS | UINT32_C(1) << 2 * VXM_SHORT_BITS)

/** The sieve of a job; false if it has none, as points or the solid are not in its form. */
bool vxm_sieve_of(vxm_sieve *sieve, const vxm_thin_job *job);

/** Whether cells along the axes of a window can have short numbers (VXM_SHORT_BITS). */
bool vxm_cells_fit_short(const vxm_window *window);

/** Whether a window can have the maps of vxm_thin_job: it has no padding between slices, and is not too
 * large.
 */
bool vxm_middles_fit(const vxm_window *window);
/** Words from one map to the next: some more than a window has, as processors take a load for one of what was
 * stored a multiple of 4096 bytes away, and wait. */
static inline size_t vxm_middle_words(size_t window_words) {
  return window_words + 8;
}

/** Words of all maps: four bytes can be read from any bit on. */
static inline size_t vxm_all_middle_words(size_t window_words) {
  return VXM_MIDDLES * vxm_middle_words(window_words);
}

/** Fills them. The first voxels along an axis have no others before them, and no bits that mean something,
 * but along the fast axis. */
void vxm_middles_fill(uint64_t *middles, const vxm_window *window);

#endif
