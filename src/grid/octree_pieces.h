/* SPDX-License-Identifier: BSD-3-Clause */
/** An octree of blocks and boxes that come in any order, and may overlap. */
#ifndef VXM_GRID_OCTREE_PIECES_H
#define VXM_GRID_OCTREE_PIECES_H

#include "grid/octree.h"

/** A brick, or a cube of 4^n bricks along each side that is full. */
typedef struct vxm_octree_piece {
  uint64_t key; /**< Morton number of its first brick */
  uint64_t bits;
  uint64_t bricks; /**< 1, 64, 64^2, ...; several are full */
} vxm_octree_piece;

typedef struct vxm_octree_pieces {
  vxm_context *context;
  vxm_space space;
  vxm_octree_piece *list;
  size_t count, capacity;
  vxm_status status; /**< after the first failure nothing is added any more */
  vxm_error *error;
} vxm_octree_pieces;

/** Sets voxels of one brick, whose first voxel is `at`, a multiple of 4; those beyond the grid are left out.
 */
void vxm_octree_pieces_brick(vxm_octree_pieces *pieces, const int64_t at[3], uint64_t bits);
/** Sets all voxels begin..end-1 that the grid has. */
void vxm_octree_pieces_box(vxm_octree_pieces *pieces, const int64_t begin[3], const int64_t end[3]);
/** Sets the voxels of a window in the layout of a grid, whose space begins at voxel `first` of the grid, the
 * x of it a multiple of 64. */
void vxm_octree_pieces_window(vxm_octree_pieces *pieces, const vxm_window *window, const int64_t first[3]);
/** The bits of a brick that lie in a box of voxels. */
uint64_t vxm_octree_bits_within(const int64_t at[3], const int64_t begin[3], const int64_t end[3]);
/** Makes the octree, and frees the list, also after a failure. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_octree_pieces_end(vxm_sparse **out, vxm_octree_pieces *pieces);

#endif
