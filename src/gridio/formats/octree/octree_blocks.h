/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Blocks of an octree: its tiles, and cubes as large where it is full. Those that are not empty are numbered
 * in Morton order.
 */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_BLOCKS_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_BLOCKS_H

#include "gridio/formats/octree/octree_file.h"

/** A node or brick, or what stands for it. */
typedef struct vxm_octree_part {
  vxm_octree_state kind;
  size_t index; /**< of a mixed one, among the nodes of its level or the bricks */
} vxm_octree_part;

/** A child of a node of a level. */
static inline vxm_octree_part vxm_octree_child_part(const vxm_sparse *sparse, int level, vxm_octree_part node,
                                                    unsigned child) {
  if (node.kind != VXM_OCTREE_MIXED)
    return node;
  const vxm_octree_node *children = &sparse->nodes[level][node.index];
  if (children->mixed >> child & 1)
    return (vxm_octree_part){VXM_OCTREE_MIXED, vxm_octree_index(children, child)};
  return (vxm_octree_part){children->full >> child & 1 ? VXM_OCTREE_FULL : VXM_OCTREE_EMPTY, 0};
}

/** The children of a node that are not empty, as bits. */
static inline uint64_t vxm_octree_children(const vxm_sparse *sparse, int level, vxm_octree_part node) {
  if (node.kind != VXM_OCTREE_MIXED)
    return node.kind == VXM_OCTREE_FULL ? ~UINT64_C(0) : 0;
  return sparse->nodes[level][node.index].mixed | sparse->nodes[level][node.index].full;
}

/** Called for a block. @return whether to go on */
typedef bool (*vxm_octree_block_fn)(uint64_t number, const int64_t at[3], void *payload);

/**
 * Calls for each block that meets the box of voxels begin..end-1, in Morton order.
 *
 * @param nodes of all levels above tiles, of a file or an octree
 * @return how many blocks there are, in the box or not
 */
uint64_t vxm_octree_each_block(vxm_octree_node *const nodes[VXM_OCTREE_LEVELS], int levels,
                               const int64_t begin[3], const int64_t end[3], vxm_octree_block_fn function,
                               void *payload);

/** The node of a level that begins at a voxel. */
vxm_octree_part vxm_octree_part_at(const vxm_sparse *sparse, int level, const int64_t at[3]);

#endif
