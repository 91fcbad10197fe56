/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A set of voxels whose memory follows its surface: the sparse voxel octree of Schwarz & Seidel 2010, section
 * 5. A vxm_sparse of the public header.
 *
 * A brick is 4 x 4 x 4 voxels in one word, voxel (x,y,z) of it bit 16 z + 4 y + x. Only mixed bricks are
 * stored, neither empty nor full. A node holds two levels of the octree at once: 4 x 4 x 4 children in Morton
 * order (bit x0 + 2 y0 + 4 z0 + 8 x1 + 16 y1 + 32 z1 for the child at x0 + 2 x1 and so on), of which it says
 * which are mixed and which are full; a byte of these words is the children of one node of the octree. Nodes
 * of level 0 have bricks as children, those of level l nodes of level l - 1. The mixed children of all nodes
 * of a level lie in Morton order. The form is canonical: equal sets have equal words.
 *
 * Voxels beyond the dimensions are clear.
 */
#ifndef VXM_GRID_OCTREE_H
#define VXM_GRID_OCTREE_H

#include "grid/window.h"
#include "voxmend/sparse.h"

/** Levels of nodes at most: 4^10 = VXM_DIM_MAX. */
enum { VXM_OCTREE_LEVELS = 10 };

typedef struct vxm_octree_node {
  uint64_t mixed, full; /**< children, disjoint */
  uint64_t first;       /**< index of the first mixed child; 0 if there is none */
} vxm_octree_node;

struct vxm_sparse {
  vxm_context *context; /**< one reference held */
  vxm_space space;
  int levels; /**< of nodes, at least 1; the last one has one node, the root */
  vxm_octree_node *nodes[VXM_OCTREE_LEVELS];
  size_t node_count[VXM_OCTREE_LEVELS];
  uint64_t *bricks;
  size_t brick_count;
  uint64_t serial; /**< no two have the same */
  vxm_warnings warnings;
};

/** Levels of nodes that a space needs. */
int vxm_octree_levels(const vxm_space *space);
/** An octree without nodes or bricks, which are still to be given. The space has been checked. */
vxm_status vxm_octree_new(vxm_sparse **out, vxm_context *context, const vxm_space *space, vxm_error *error);

/** Voxels along a child of a node of a level. */
static inline int64_t vxm_octree_side(int level) {
  return INT64_C(4) << (2 * level);
}

/** Whether a cube has voxels of the box from `begin` to before `end`. */
static inline bool vxm_cube_meets(const int64_t at[3], int64_t side, const int64_t begin[3],
                                  const int64_t end[3]) {
  bool meets = true;
  for (int a = 0; a < 3; a++)
    meets &= at[a] < end[a] && at[a] + side > begin[a];
  return meets;
}

/** The child at (x,y,z), each 0 to 3. */
static inline unsigned vxm_octree_child(unsigned x, unsigned y, unsigned z) {
  static const unsigned char spread[4] = {0, 1, 8, 9};
  return (unsigned)(spread[x & 3] | spread[y & 3] << 1 | spread[z & 3] << 2);
}

/** The Morton number of the cube at (x,y,z) among those of its size: bits of x, y and z in turn, x first. */
static inline uint64_t vxm_octree_morton(int64_t x, int64_t y, int64_t z) {
  const uint64_t at[3] = {(uint64_t)x, (uint64_t)y, (uint64_t)z};
  uint64_t number = 0;
  for (int b = 0; b < 2 * VXM_OCTREE_LEVELS; b++)
    for (int a = 0; a < 3; a++)
      number |= (at[a] >> b & 1) << (3 * b + a);
  return number;
}

/** The bit of a voxel in its brick. */
static inline unsigned vxm_octree_bit(int64_t i, int64_t j, int64_t k) {
  return (unsigned)((k & 3) * 16 + (j & 3) * 4 + (i & 3));
}

/** The voxels of a brick from `at` on that are within the dimensions. */
uint64_t vxm_octree_box(const int64_t dims[3], const int64_t at[3]);

/** Where a child lies: x, y and z. */
static inline void vxm_octree_place(unsigned child, int64_t place[3]) {
  for (int a = 0; a < 3; a++)
    place[a] = (child >> a & 1) | (child >> (a + 2) & 2);
}

/** The first voxel of a child that is `side` voxels long, of a node whose first voxel is `at`. */
static inline void vxm_octree_child_at(int64_t out[3], const int64_t at[3], unsigned child, int64_t side) {
  vxm_octree_place(child, out);
  for (int a = 0; a < 3; a++)
    out[a] = at[a] + out[a] * side;
}

/** The index of a mixed child among those of its level. */
static inline size_t vxm_octree_index(const vxm_octree_node *node, unsigned child) {
  return (size_t)node->first + (size_t)vxm_popcount(node->mixed & vxm_low_bits(child));
}

/** Calls for each piece that meets the box of voxels begin..end-1, in Morton order. */
void vxm_octree_walk(const vxm_sparse *sparse, const int64_t begin[3], const int64_t end[3],
                     vxm_sparse_fn function, void *payload);
/** The same for layers begin..end-1 along an axis. */
void vxm_octree_walk_layers(const vxm_sparse *sparse, int axis, int64_t begin, int64_t end,
                            vxm_sparse_fn function, void *payload);

/** The brick with voxel (i,j,k), which lies within the dimensions. */
uint64_t vxm_octree_brick(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k);
/** Sets voxels of the brick with voxel (i,j,k) if it is mixed, which it is to stay; the serial changes. */
void vxm_octree_set_bits(vxm_sparse *sparse, int64_t i, int64_t j, int64_t k, uint64_t bits);
/** The node of a level with voxel (i,j,k), which lies within the dimensions; or one that is as empty or as
 * full, where a higher one is. */
const vxm_octree_node *vxm_octree_node_at(const vxm_sparse *sparse, int level, int64_t i, int64_t j,
                                          int64_t k);
/** The same of the level below that of a node with the voxel, which is above 0. */
const vxm_octree_node *vxm_octree_below(const vxm_sparse *sparse, int level, const vxm_octree_node *node,
                                        int64_t i, int64_t j, int64_t k);
/** The same of level 0. */
const vxm_octree_node *vxm_octree_low_node(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k);
/** Whether voxel (i,j,k) is set; false outside. */
bool vxm_octree_get(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k);
/** vxm_grid_count and vxm_grid_hash of the same voxels. */
void vxm_octree_count_hash(const vxm_sparse *sparse, int64_t *count, uint64_t *hash);
/** Replaces the words of a window, in any layout, on the threads of the octree's context. */
void vxm_octree_fill(const vxm_sparse *sparse, const vxm_window *window);
/** Takes the next slices. */
typedef vxm_status (*vxm_octree_window_fn)(const vxm_window *window, void *payload, vxm_error *error);
/**
 * Goes through the octree in windows of `slices` slices, the last one of fewer.
 *
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT; what `function` returns first that is another
 */
vxm_status vxm_octree_each_window(const vxm_sparse *sparse, vxm_layout layout, int64_t slices,
                                  vxm_octree_window_fn function, void *payload, vxm_error *error);
/** Number of nodes of all levels, and bytes that the octree takes. */
size_t vxm_octree_nodes(const vxm_sparse *sparse);
uint64_t vxm_octree_bytes(const vxm_sparse *sparse);

/** See vxm_sparse_combine in voxmend.h; `b` is not looked at for the complement. */
vxm_status vxm_octree_combine(vxm_sparse **out, const vxm_sparse *a, const vxm_sparse *b,
                              vxm_set_operation op, vxm_error *error);

#endif
