/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * How many voxels a grid has set, and its hash, from windows in any layout.
 *
 * Both follow the steps along x: voxel (i,j,k) is a step if it differs from (i-1,j,k), outside the grid all
 * being clear. A step up at i begins nx - i set voxels and a step down ends them, so the steps give the
 * count. The hash is that of the dimensions plus, modulo 2^64, a mix of the index (k*ny + j)*nx + i of each
 * step. Sums have no order: any windows in any layout give the same, and the work follows the surface where
 * whole words are alike.
 */
#ifndef VXM_GRID_COUNT_HASH_H
#define VXM_GRID_COUNT_HASH_H

#include "grid/window.h"

/** Sums of some slices; those of all slices of a space, added up, are those of the grid. */
typedef struct vxm_count_hash {
  int64_t count; /**< set voxels, once all slices are in: where slices run along x a part is not of its own */
  uint64_t hash;
} vxm_count_hash;

/** Sum of no slices of this space: count 0, and the hash of the dimensions. */
vxm_count_hash vxm_count_hash_start(const vxm_space *space);

/**
 * Adds all slices of a window on the threads of a context; the same in any number of them.
 *
 * @param sum    one that vxm_count_hash_start made, or zeros for a part to be added to such a one
 * @param before the words of the slice before the window's first, where slices run along x; otherwise, and
 *               where the first is slice 0, it is not looked at
 */
void vxm_count_hash_add(vxm_count_hash *sum, vxm_context *context, const vxm_window *window,
                        const uint64_t *before);

/** Adds a part that began as zeros. */
static inline void vxm_count_hash_join(vxm_count_hash *sum, vxm_count_hash part) {
  sum->count += part.count;
  sum->hash += part.hash;
}

#endif
