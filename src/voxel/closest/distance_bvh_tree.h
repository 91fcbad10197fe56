/* SPDX-License-Identifier: BSD-3-Clause */
/** The inside of the tree, for distance_bvh.c and the builds of distance_bvh_body.inc. */
#ifndef VXM_VOXEL_CLOSEST_DISTANCE_BVH_TREE_H
#define VXM_VOXEL_CLOSEST_DISTANCE_BVH_TREE_H

#include "voxel/closest/distance_bvh.h"
#include "voxel/closest/triangle_distance.h"

enum { VXM_PACK = 8, VXM_DISTANCE_BVH_LEVELS = 11 /**< 8^11 triangles are more than 2^32 */ };

/** A leaf: eight triangles as floats, as seen from a point among them, for telling which cannot be the
 * nearest.
 */
typedef struct vxm_pack {
  _Alignas(64) double origin[3];
  float reach; /**< from the origin, of anything in here */
  float base[3][VXM_PACK], axis[3][3][VXM_PACK];
  float length[VXM_PACK], apex[2][VXM_PACK];
  float leg[2][2][VXM_PACK], leg_length[2][VXM_PACK];
} vxm_pack;

/** An inner node: the boxes of up to eight children, as seen from a point among them. */
typedef struct vxm_bvh_node {
  _Alignas(64) double origin[3];
  float reach;
  uint32_t valid; /**< a bit for each child */
  float low[3][VXM_PACK], high[3][VXM_PACK];
} vxm_bvh_node;

/**
 * Triangles in an order in which those of a pack, and packs side by side, are near each other. Child c of
 * node f of level 0 is pack 8 f + c; of a level above, node 8 f + c of the level below. The last level
 * has one node, the root; there are at least two levels.
 */
struct vxm_distance_bvh {
  vxm_context *context;
  size_t count, pack_count;
  vxm_distance_triangle *triangles;
  vxm_pack *packs;
  int levels;
  vxm_bvh_node *nodes[VXM_DISTANCE_BVH_LEVELS];
  size_t node_count[VXM_DISTANCE_BVH_LEVELS];
};

/** Those children of a node that have a bit in `mask`. */
typedef struct vxm_bvh_children {
  uint32_t node, mask;
} vxm_bvh_children;

struct vxm_search {
  const vxm_distance_bvh *tree;
  size_t near;                   /**< a triangle near the points looked at last */
  vxm_bvh_children *tile_nodes;  /**< of level 1: what a tile has to look at */
  vxm_bvh_children *block_nodes; /**< of level 0: what a block of it has to look at */
};

#endif
