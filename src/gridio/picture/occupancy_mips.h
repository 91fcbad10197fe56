/* SPDX-License-Identifier: BSD-3-Clause */
/** How full the blocks of a grid are, at 4, 8, 16, ... voxels a side: to skip empty space, and to see how
 * open a place is. */
#ifndef VXM_GRIDIO_PICTURE_OCCUPANCY_MIPS_H
#define VXM_GRIDIO_PICTURE_OCCUPANCY_MIPS_H

#include "grid/bitgrid.h"

/** 4 << 18 covers VXM_DIM_MAX. */
enum { VXM_OCCUPANCY_LEVELS = 19 };

/** A cell of level l covers (4 << l)^3 voxels: 0 if all are clear, up to 255 if all are set. */
typedef struct vxm_occupancy_mips {
  vxm_context *context;
  int64_t dims[3];  /**< of the grid */
  uint64_t *blocks; /**< the voxels of each cell of level 0: bit 16 * z + 4 * y + x, coordinates modulo 4 */
  uint8_t *gaps;    /**< for each of them, in how many levels from 0 on the cell around it is empty */
  int levels;
  struct {
    int64_t dims[3];
    uint8_t *cells; /**< x fastest */
  } level[VXM_OCCUPANCY_LEVELS];
} vxm_occupancy_mips;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_occupancy_mips_create(vxm_occupancy_mips *out, const vxm_grid *grid, vxm_error *error);
void vxm_occupancy_mips_destroy(vxm_occupancy_mips *mips);

/** The cell of level 0 that holds a voxel. */
static inline int64_t vxm_occupancy_mips_index(const vxm_occupancy_mips *p, const int64_t voxel[3]) {
  const int64_t *dims = p->level[0].dims;
  return ((voxel[2] >> 2) * dims[1] + (voxel[1] >> 2)) * dims[0] + (voxel[0] >> 2);
}

/** The cell of a level that holds voxel (i,j,k) of the grid. */
static inline uint8_t vxm_occupancy_mips_cell(const vxm_occupancy_mips *p, int level,
                                              const int64_t voxel[3]) {
  int shift = level + 2;
  const int64_t *dims = p->level[level].dims;
  return p->level[level]
      .cells[((voxel[2] >> shift) * dims[1] + (voxel[1] >> shift)) * dims[0] + (voxel[0] >> shift)];
}

/** Fullness around a point (in voxels), 0 to 1, interpolated between the centres of cells. */
double vxm_occupancy_mips_sample(const vxm_occupancy_mips *mips, int level, const double point[3]);

#endif
