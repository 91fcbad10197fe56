/* SPDX-License-Identifier: BSD-3-Clause */
/** An octree in the making whose nodes and bricks come in Morton order, each after all that is below it. */
#ifndef VXM_GRID_OCTREE_GROWTH_H
#define VXM_GRID_OCTREE_GROWTH_H

#include "grid/octree.h"

/** What a brick or node turned out to be. */
typedef enum vxm_octree_state { VXM_OCTREE_EMPTY, VXM_OCTREE_FULL, VXM_OCTREE_MIXED } vxm_octree_state;

/** Nodes of a level, or bricks, side by side in another octree, and where they go. */
typedef struct vxm_octree_run {
  const vxm_sparse *from;
  size_t begin, count, to;
  uint64_t shift; /**< what is added to `first` of nodes that have mixed children */
} vxm_octree_run;

/** Runs in the order of where they go, which are copied in the end, by all threads: these share pages that
 * are touched for the first time, too. */
typedef struct vxm_octree_runs {
  vxm_octree_run *list;
  size_t count, capacity;
} vxm_octree_runs;

typedef struct vxm_octree_growth {
  vxm_sparse *sparse; /**< NULL once it was taken */
  size_t node_capacity[VXM_OCTREE_LEVELS], brick_capacity;
  vxm_octree_runs runs[1 + VXM_OCTREE_LEVELS]; /**< of bricks, then of the nodes of each level */
  vxm_status status;                           /**< after the first failure nothing is added any more */
  vxm_error *error;
} vxm_octree_growth;

/** Begins an octree. End with vxm_octree_growth_end, also after a failure. @param error stays in use */
void vxm_octree_growth_begin(vxm_octree_growth *out, vxm_context *context, const vxm_space *space,
                             vxm_error *error);

/** Makes room for as much as two octrees have together, before anything is added. */
void vxm_octree_growth_reserve(vxm_octree_growth *growth, const vxm_sparse *a, const vxm_sparse *b);

/** Where the next child of a node of a level will be: its `first`. */
static inline size_t vxm_octree_growth_next(const vxm_octree_growth *growth, int level) {
  return level > 0 ? growth->sparse->node_count[level - 1] : growth->sparse->brick_count;
}

/** Adds a brick, unless it is empty or full. */
vxm_octree_state vxm_octree_growth_brick(vxm_octree_growth *growth, uint64_t bits);
/** Adds a node whose children are there from `first` on, unless it is empty or full; the root always. */
vxm_octree_state vxm_octree_growth_node(vxm_octree_growth *growth, int level, uint64_t mixed, uint64_t full,
                                        size_t first);

/** Adds a mixed node of another octree of as many levels, below its root, with all that is below it; that one
 * is to stay as it is until the end. */
vxm_octree_state vxm_octree_growth_copy(vxm_octree_growth *growth, const vxm_sparse *from, int level,
                                        size_t node);

/** Hands the octree over, or drops it after a failure. @return growth->status */
vxm_status vxm_octree_growth_end(vxm_sparse **out, vxm_octree_growth *growth);

#endif
