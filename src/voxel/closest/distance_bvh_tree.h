/* SPDX-License-Identifier: BSD-3-Clause */
/** The inside of the tree, for distance_bvh.c and the builds of distance_bvh_body.inc. */
#ifndef VXM_VOXEL_CLOSEST_DISTANCE_BVH_TREE_H
#define VXM_VOXEL_CLOSEST_DISTANCE_BVH_TREE_H

#include "voxel/closest/distance_bvh.h"
#include "voxel/closest/triangle_distance.h"

enum { VXM_PACK = 8, VXM_DISTANCE_BVH_LEVELS = 11 /**< 8^11 triangles are more than 2^32 */ };

/** Eight triangles as floats, as seen from a point among them: for telling which cannot be the nearest. */
typedef struct vxm_pack {
  _Alignas(64) double origin[3];
  float reach; /**< from the origin, of anything in here */
  float base[3][VXM_PACK], axis[3][3][VXM_PACK];
  float length[VXM_PACK], apex[2][VXM_PACK];
  float leg[2][2][VXM_PACK], leg_length[2][VXM_PACK];
} vxm_pack;

/** The boxes of up to eight children, as seen from a point among them. */
typedef struct vxm_family {
  _Alignas(64) double origin[3];
  float reach;
  uint32_t valid; /**< a bit for each child */
  float low[3][VXM_PACK], high[3][VXM_PACK];
} vxm_family;

/**
 * Triangles in an order in which those of a pack, and packs side by side, are near each other. Child c of
 * family f of level 0 is pack 8 f + c; of a level above, family 8 f + c of the level below. The last level
 * has one family, the root; there are at least two levels.
 */
struct vxm_distance_bvh {
  vxm_context *context;
  size_t count, pack_count;
  vxm_distance_triangle *triangles;
  vxm_pack *packs;
  int levels;
  vxm_family *families[VXM_DISTANCE_BVH_LEVELS];
  size_t family_count[VXM_DISTANCE_BVH_LEVELS];
};

/** Some children of a family. */
typedef struct vxm_some {
  uint32_t family, mask;
} vxm_some;

struct vxm_search {
  const vxm_distance_bvh *tree;
  size_t near;             /**< a triangle near the points looked at last */
  vxm_some *wide, *narrow; /**< families of levels 1 and 0 that a tile, and a block of it, have to look at */
};

#endif
