/* SPDX-License-Identifier: BSD-3-Clause */
/** How many voxels are set in each cube of a coarser grid: the coverage of Schwarz & Seidel 2010, section 5,
 * at any level of the octree. */
#ifndef VXM_GRID_OCTREE_COUNT_H
#define VXM_GRID_OCTREE_COUNT_H

#include "grid/octree.h"

/** A box of cubes, begin..end-1 along each axis, and what has been counted in them. */
typedef struct vxm_octree_counts {
  int64_t side; /**< voxels along a cube, a power of two */
  int64_t begin[3], end[3];
  uint64_t *counts; /**< [x][y][z] of the box, z fastest */
} vxm_octree_counts;

/** Adds the voxels of a cube that is full. */
void vxm_octree_count_cube(const vxm_octree_counts *box, const int64_t at[3], int64_t side);
/** Adds voxels that are all in the cube with the voxel `at`. */
void vxm_octree_count_some(const vxm_octree_counts *box, const int64_t at[3], uint64_t voxels);
/** Adds the voxels of an octree. */
void vxm_octree_count(const vxm_octree_counts *box, const vxm_sparse *sparse);

#endif
