/* SPDX-License-Identifier: BSD-3-Clause */
/** Distances handed on tile by tile: those within the band, and what is inside beyond it. */
#ifndef VXM_VOXEL_FIELDS_DISTANCE_TILES_H
#define VXM_VOXEL_FIELDS_DISTANCE_TILES_H

#include "voxel/closest/band_tile.h"
#include "voxel/fields/field.h"

/** What a worker has for it. */
typedef struct vxm_distance_tiles {
  const vxm_field_target *target;
  vxm_error error; /**< of the first tile that was refused; others are then left out */
  float values[VXM_BAND_TILE * VXM_BAND_TILE * VXM_BAND_TILE];
} vxm_distance_tiles;

/* `out` describes the grid from the first voxel of the tile on: its values are not written, as they go to the
 * target instead; only its signs, band and side are used. */

/** Puts a tile that has been measured. */
void vxm_distance_tiles_finish(vxm_distance_tiles *tiles, const vxm_band_kernels *kernels,
                               const vxm_band_values *out, const vxm_band_tile *tile, vxm_band_tally *tally);

/** Puts those tiles of a row of them, all beyond the band, that have voxels inside. `at` is the first voxel,
 * `count` the voxels of the row. */
void vxm_distance_tiles_fill(vxm_distance_tiles *tiles, const vxm_band_kernels *kernels,
                             const vxm_band_values *out, const int64_t at[3], const int64_t count[3],
                             vxm_band_tally *tally);

#endif
