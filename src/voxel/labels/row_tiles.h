/* SPDX-License-Identifier: BSD-3-Clause */
/** Rows and slices cut into tiles, each of which is one thread's: no two write the same voxel. */
#ifndef VXM_VOXEL_LABELS_ROW_TILES_H
#define VXM_VOXEL_LABELS_ROW_TILES_H

#include "base/bits.h"

enum { VXM_TILE_ROWS = 16 };

/** Rows (first) and slices begin..end-1. */
typedef struct vxm_row_tile {
  int64_t begin[2], end[2];
} vxm_row_tile;

static inline size_t vxm_row_tiles_across(const vxm_row_tile *whole, int axis) {
  return (size_t)((whole->end[axis] - whole->begin[axis] + VXM_TILE_ROWS - 1) / VXM_TILE_ROWS);
}

static inline size_t vxm_row_tiles_count(const vxm_row_tile *whole) {
  return vxm_row_tiles_across(whole, 0) * vxm_row_tiles_across(whole, 1);
}

static inline vxm_row_tile vxm_row_tiles_at(const vxm_row_tile *whole, size_t number) {
  size_t across = vxm_row_tiles_across(whole, 0), at[2] = {number % across, number / across};
  vxm_row_tile tile;
  for (int a = 0; a < 2; a++) {
    tile.begin[a] = whole->begin[a] + (int64_t)at[a] * VXM_TILE_ROWS;
    tile.end[a] = vxm_min(tile.begin[a] + VXM_TILE_ROWS, whole->end[a]);
  }
  return tile;
}

#endif
