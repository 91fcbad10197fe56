/* SPDX-License-Identifier: BSD-3-Clause */
/** A voxel sink (sandbox/voxel_sink.h) that fills a grid, a field or an octree. */
#ifndef VXM_GRIDIO_COMMON_SINK_FILL_H
#define VXM_GRIDIO_COMMON_SINK_FILL_H

#include "grid/octree_pieces.h"
#include "gridio/common/values.h"
#include "sandbox/voxel_sink.h"

/** What is filled: one of the three. */
typedef struct vxm_sink_filling {
  vxm_grid *grid;
  vxm_field *field; /**< of 32-bit floats */
  vxm_octree_pieces *pieces;
  int64_t low[3]; /**< index of voxel (0,0,0) of it */
} vxm_sink_filling;

/* As the functions of vxm_voxel_sink. What lies beyond the space is left out. */

void vxm_sink_fill_bits(vxm_sink_filling *filling, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]);
void vxm_sink_fill_numbers(vxm_sink_filling *filling, const int64_t at[3],
                           const float numbers[VXM_SINK_VOXELS]);
void vxm_sink_fill_cube(vxm_sink_filling *filling, const int64_t at[3], int64_t side, float number);

#endif
