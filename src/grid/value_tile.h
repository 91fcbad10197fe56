/* SPDX-License-Identifier: BSD-3-Clause */
/** A box of values out of a field, for files that hold tiles rather than slices. */
#ifndef VXM_GRID_VALUE_TILE_H
#define VXM_GRID_VALUE_TILE_H

#include <stddef.h>
#include <stdint.h>

/** Voxels along a tile, but at the end of the space; they begin at multiples of a quarter. */
enum { VXM_VALUE_TILE = 32 };

/** The order of threes is that of the field: fast, middle, slow. */
typedef struct vxm_value_tile {
  int64_t first[3];
  int count[3];        /**< 1 to VXM_VALUE_TILE */
  const float *values; /**< NULL = all are `value` */
  size_t row, slice;   /**< values from one row to the next, from one slice to the next */
  float value;
} vxm_value_tile;

#endif
