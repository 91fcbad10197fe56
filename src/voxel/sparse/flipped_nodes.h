/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Flips of strips, put to the bricks of the nodes that have some: few of all nodes do.
 *
 * A record is a strip along y, above the 8 bits of a row in it, 16 y + z, above a place along x of
 * `row_shift` bits.
 */
#ifndef VXM_VOXEL_SPARSE_FLIPPED_NODES_H
#define VXM_VOXEL_SPARSE_FLIPPED_NODES_H

#include "grid/octree_build.h"

/** Where a row of a strip lies: in which row of bricks in the order of vxm_strip_add_node, and at which bits
 * of them. */
typedef struct vxm_strip_place {
  uint8_t row, shift;
} vxm_strip_place;

typedef struct vxm_flipped_nodes {
  vxm_context *context;
  int row_shift;
  uint32_t *slots;  /**< of all nodes, strip after strip, 2^(row_shift - 4) of each: 0, or one more than the
                       place  of its bricks */
  uint8_t *touched; /**< per strip: whether one of its nodes has flips */
  uint64_t *bricks; /**< of nodes, in the order of vxm_strip_add_node; clear behind `count` nodes */
  size_t count, capacity;
  vxm_strip_place places[256];
} vxm_flipped_nodes;

/** Bytes for so many strips, whatever is flipped in them. */
uint64_t vxm_flipped_nodes_bytes(size_t strips, int row_shift);

/** Nodes of so many strips, without flips. Destroy it also after a failure. */
vxm_status vxm_flipped_nodes_create(vxm_flipped_nodes *out, vxm_context *context, size_t strips,
                                    int row_shift, vxm_error *error);
void vxm_flipped_nodes_destroy(vxm_flipped_nodes *nodes);

/** Flips records of any strips. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_flipped_nodes_flip(vxm_flipped_nodes *nodes, const uint64_t *records, size_t count);
/** The same of a bitmap: bit i of it is record i. */
vxm_status vxm_flipped_nodes_flip_bitmap(vxm_flipped_nodes *nodes, const uint64_t *words, size_t count);
/** The same of records of strip 0. */
vxm_status vxm_flipped_nodes_flip_strip(vxm_flipped_nodes *nodes, const uint32_t *records, size_t count);

/** Whether a node of a strip has flips; `*x` becomes the first that does, from there on. */
static inline bool vxm_flipped_nodes_next(const vxm_flipped_nodes *nodes, size_t strip, size_t *x) {
  const size_t size = (size_t)1 << (nodes->row_shift - 4);
  const uint32_t *slots = nodes->slots + strip * size;
  while (*x < size && !slots[*x])
    ++*x;
  return *x < size;
}

/** The bricks of such a node, to be cleared; it has no flips from now on. */
static inline uint64_t *vxm_flipped_nodes_take(vxm_flipped_nodes *nodes, size_t strip, size_t x) {
  uint32_t *slot = &nodes->slots[(strip << (nodes->row_shift - 4)) + x];
  uint64_t *bricks = nodes->bricks + (size_t)(*slot - 1) * VXM_STRIP_BRICKS;
  *slot = 0;
  return bricks;
}

/** Whether a node of a strip has had flips; from now on none has. */
static inline bool vxm_flipped_nodes_touch_end(vxm_flipped_nodes *nodes, size_t strip) {
  bool touched = nodes->touched[strip];
  nodes->touched[strip] = 0;
  return touched;
}

/** All nodes have been taken. */
static inline void vxm_flipped_nodes_end(vxm_flipped_nodes *nodes) {
  nodes->count = 0;
}

#endif
