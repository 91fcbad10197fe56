/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Building an octree from strips: rows of nodes of level 0, 16 x 16 voxels thick and running along x, in any
 * order and by all threads. Runs of full nodes are not taken apart: sixteen strips side by side are merged to
 * one of the next level, and so on to the root.
 */
#ifndef VXM_GRID_OCTREE_BUILD_H
#define VXM_GRID_OCTREE_BUILD_H

#include "grid/block_arena.h"
#include "grid/octree.h"

#include <stdatomic.h>

/** Voxels along a node of level 0. */
enum { VXM_STRIP_VOXELS = 16, VXM_STRIP_BRICKS = 64 };

/** A node still to be put into its place. */
typedef struct vxm_seed {
  uint64_t mixed, full;
  const void
      *children; /**< of level 0: its mixed bricks; else its mixed children as seeds; in Morton order */
} vxm_seed;

/** Nodes begin..end-1 of a strip: one that is not full, or a run of full ones. */
typedef struct vxm_strip_item {
  uint32_t begin, end;
  vxm_seed seed; /**< all `full` for a run */
} vxm_strip_item;

/** Items in increasing order, with gaps of empty nodes. */
typedef struct vxm_strip {
  const vxm_strip_item *items;
  size_t count;
} vxm_strip;

/** What a worker has made, by how long it is needed. Each has cache lines of its own: it changes with every
 * node. */
typedef struct vxm_strip_arena {
  _Alignas(64) vxm_block_arena bricks; /**< to the end */
  vxm_block_arena seeds;               /**< above level 0: until all of level 0 are gathered */
  vxm_block_arena strips[2];           /**< until they are merged to those of the next level, in turn */
  vxm_strip_item *items;               /**< of the strip being made */
  size_t item_count, item_capacity;
} vxm_strip_arena;

typedef struct vxm_octree_builder {
  vxm_context *context;
  vxm_space space;
  size_t across, deep; /**< strips along y and z */
  vxm_strip *strips;   /**< strip (y,z) is z * across + y */
  vxm_strip_arena *arenas;
  size_t workers;
  unsigned turn;     /**< which arena strips go to */
  atomic_int failed; /**< a vxm_status */
} vxm_octree_builder;

/** A builder in which all strips are empty. Destroy with vxm_octree_builder_destroy, also after a failure. */
vxm_status vxm_octree_builder_create(vxm_octree_builder *out, vxm_context *context, const vxm_space *space,
                                     vxm_error *error);
void vxm_octree_builder_destroy(vxm_octree_builder *builder);
/** Says why memory ran out while strips were made, or VXM_OK. */
vxm_status vxm_octree_builder_check(const vxm_octree_builder *builder, vxm_error *error);

/* A strip is made by one worker: nodes and runs in increasing order, then the end. */

/**
 * The bricks of node (x, y, z) stand at 16 x + r with r = y0 + 2 z0 + 4 y1 + 8 z1, for the brick at x and at
 * y0 + 2 y1, z0 + 2 z1; voxels beyond the dimensions are clear.
 */
void vxm_strip_add_node(vxm_octree_builder *builder, size_t worker, size_t x,
                        const uint64_t bricks[VXM_STRIP_BRICKS]);
/** The same where it is known which bricks are not empty, and which are full: bit b for brick b. */
void vxm_strip_add_known(vxm_octree_builder *builder, size_t worker, size_t x,
                         const uint64_t bricks[VXM_STRIP_BRICKS], uint64_t set, uint64_t full);
/** Rows of a strip: `y_count` side by side in each of `z_count` slices, both 1 to 16. */
typedef struct vxm_strip_rows {
  const uint64_t *words;         /**< of the first row */
  size_t row_words, slice_words; /**< from one row or slice to the next */
  int y_count, z_count;
} vxm_strip_rows;

/** The nodes that words begin..end-1 of the rows have, 64 voxels each. */
void vxm_strip_add_words(vxm_octree_builder *builder, size_t worker, const vxm_strip_rows *rows, size_t begin,
                         size_t end);
void vxm_strip_add_full(vxm_octree_builder *builder, size_t worker, size_t begin, size_t end);
/** Puts what was added in the place of the strip (y,z). */
void vxm_strip_end(vxm_octree_builder *builder, size_t worker, size_t y, size_t z);

/** The bricks of an item that is not a run, in the order of vxm_strip_add_node. */
void vxm_strip_expand(const vxm_strip_item *item, uint64_t bricks[VXM_STRIP_BRICKS]);

/** Adds a window in the layout of a grid, which begins and ends at whole strips or at the end of the grid. */
void vxm_octree_builder_add(vxm_octree_builder *builder, const vxm_window *window);

/** Makes the octree of all strips, which the builder has no more then. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_octree_builder_end(vxm_sparse **out, vxm_octree_builder *builder, vxm_error *error);

/** The octree of a grid. */
vxm_status vxm_octree_from_grid(vxm_sparse **out, const vxm_grid *grid, vxm_error *error);

#endif
