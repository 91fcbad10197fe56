/* SPDX-License-Identifier: BSD-3-Clause */
/** Which bricks of a box of voxels are meant, and which cells of 2, 4, 8, ... bricks along each axis hold
 * one. */
#ifndef VXM_VOXEL_WINDING_BRICK_MASK_H
#define VXM_VOXEL_WINDING_BRICK_MASK_H

#include "base/context.h"

enum { VXM_BRICK_LEVELS = 20 };

/** Cells of a level are 4 * 2^level voxels wide and numbered from `first` on. */
typedef struct vxm_brick_mask {
  vxm_context *context;
  int levels;
  int64_t first[VXM_BRICK_LEVELS][3], count[VXM_BRICK_LEVELS][3];
  uint8_t *cells[VXM_BRICK_LEVELS]; /**< a byte each, x fastest; in one block, the bricks first */
  size_t capacity;
} vxm_brick_mask;

/** An empty mask of so many levels for the voxels begin..end-1 along x, y and z, with the memory of the one
 * before. Start from {.context = ...}. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_brick_mask_begin(vxm_brick_mask *mask, const int64_t begin[3], const int64_t end[3],
                                int levels, vxm_error *error);
/** After bricks have been set: sets the cells that hold one. Returns whether there is any. */
bool vxm_brick_mask_raise(vxm_brick_mask *mask);
void vxm_brick_mask_destroy(vxm_brick_mask *mask);

/** The byte of the cell with the voxel `at`; NULL if there is none. */
static inline uint8_t *vxm_brick_mask_at(const vxm_brick_mask *mask, const int64_t at[3], int level) {
  int64_t index = 0;
  for (int a = 2; a >= 0; a--) {
    int64_t i = (at[a] >> (level + 2)) - mask->first[level][a];
    if (i < 0 || i >= mask->count[level][a])
      return NULL;
    index = index * mask->count[level][a] + i;
  }
  return mask->cells[level] + index;
}

#endif
