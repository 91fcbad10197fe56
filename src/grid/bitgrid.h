/* SPDX-License-Identifier: BSD-3-Clause */
/** The dense grid: one bit per voxel. A vxm_grid of the public header. */
#ifndef VXM_GRID_BITGRID_H
#define VXM_GRID_BITGRID_H

#include "base/bits.h"
#include "base/context.h"
#include "base/warnings.h"
#include "voxmend/grid.h"

/** Largest number of voxels along an axis; lattice coordinates and products are sized for it. */
#define VXM_DIM_MAX (INT64_C(1) << 20)

struct vxm_grid {
  vxm_context *context; /**< one reference held */
  vxm_space space;
  size_t row_words;    /**< (dims[0] + 63) / 64 */
  size_t slice_words;  /**< row_words * dims[1] */
  size_t word_count;   /**< slice_words * dims[2] */
  uint64_t *words;     /**< bits beyond dims[0] in the last word of a row are zero: every writer keeps that */
  uint8_t *confidence; /**< a byte per voxel, x fastest, or NULL */
  vxm_warnings warnings;
};

/** Smaller voxels have no inverse that can be multiplied by the steps of a lattice, at most 2^16. */
#define VXM_VOXEL_SIZE_MIN 0x1p-1007

/** Checks dims (1 to VXM_DIM_MAX), finite origin, positive finite voxel size. */
vxm_status vxm_space_check(const vxm_space *space, vxm_error *error);
/** Checks that meshes can be made into voxels as small as those of a space that has been checked. @return
 * VXM_OK, VXM_ERROR_RANGE */
vxm_status vxm_space_check_sizes(const vxm_space *space, vxm_error *error);
/** Bytes that a grid of this space takes. The space has been checked. */
uint64_t vxm_space_bytes(const vxm_space *space);

/** Makes room for a confidence, all 0, unless the grid has one. */
vxm_status vxm_grid_add_confidence(vxm_grid *grid, vxm_error *error);

/** See vxm_grid_combine in voxmend/grid.h; `b` is not looked at for the complement. */
vxm_status vxm_bitgrid_combine(vxm_grid **out, const vxm_grid *a, const vxm_grid *b,
                               vxm_set_operation operation, vxm_error *error);

/** vxm_grid_count and vxm_grid_hash in one go. */
void vxm_grid_count_hash(const vxm_grid *grid, int64_t *count, uint64_t *hash);

static inline uint64_t *vxm_grid_row(const vxm_grid *grid, int64_t j, int64_t k) {
  return grid->words + (size_t)k * grid->slice_words + (size_t)j * grid->row_words;
}

/** The valid bits of the last word of a row. */
static inline uint64_t vxm_grid_tail_mask(const vxm_grid *grid) {
  unsigned rest = (unsigned)(grid->space.dims[0] % 64);
  return rest ? vxm_low_bits(rest) : ~UINT64_C(0);
}

/** Sets bits begin..end-1 of a row. */
static inline void vxm_row_set_span(uint64_t *row, int64_t begin, int64_t end) {
  if (begin >= end)
    return;
  size_t first = (size_t)begin / 64, last = (size_t)(end - 1) / 64;
  uint64_t head = ~UINT64_C(0) << (begin % 64), tail = vxm_low_bits((unsigned)((end - 1) % 64) + 1);
  if (first == last) {
    row[first] |= head & tail;
    return;
  }
  row[first] |= head;
  for (size_t w = first + 1; w < last; w++)
    row[w] = ~UINT64_C(0);
  row[last] |= tail;
}

#endif
