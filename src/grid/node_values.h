/* SPDX-License-Identifier: BSD-3-Clause */
/** Values of a space that are made in nodes of 16 x 16 x 16 voxels, so that most of it need not be visited.
 */
#ifndef VXM_GRID_NODE_VALUES_H
#define VXM_GRID_NODE_VALUES_H

#include "grid/octree.h"

enum { VXM_NODE_SIDE = 16, VXM_NODE_VOXELS = VXM_NODE_SIDE * VXM_NODE_SIDE * VXM_NODE_SIDE };

/** Voxels that a node at `at` has along an axis. */
static inline int vxm_node_count(const vxm_space *space, const int64_t at[3], int axis) {
  return (int)vxm_min(space->dims[axis] - at[axis], VXM_NODE_SIDE);
}

/**
 * The voxels of a node that an octree has: row (y,z) of it is word 16 z + y, voxel x bit x.
 *
 * @return whether all 4096 are alike: then all words are, too
 */
bool vxm_node_bits(uint64_t rows[VXM_NODE_SIDE * VXM_NODE_SIDE], const vxm_sparse *sparse,
                   const int64_t at[3]);

/** Boxes of voxels, and which of them have to do with a row of nodes. */
typedef struct vxm_node_boxes {
  vxm_context *context;
  size_t count;
  int32_t (*box)[3][2]; /**< begin and end along x, y and z; to be filled by the owner */
  uint32_t *layer;      /**< those of the layer at hand */
  size_t layer_count;
  uint32_t *row; /**< those of the row at hand, of each worker */
  size_t *row_count;
} vxm_node_boxes;

/** Destroyed with vxm_node_boxes_destroy, also after a failure. */
vxm_status vxm_node_boxes_create(vxm_node_boxes *out, vxm_context *context, size_t count, vxm_error *error);
void vxm_node_boxes_destroy(vxm_node_boxes *boxes);
/** Bytes that so many take. */
uint64_t vxm_node_boxes_bytes(size_t count, int workers);
void vxm_node_boxes_begin_layer(vxm_node_boxes *boxes, int64_t z);
void vxm_node_boxes_begin_row(vxm_node_boxes *boxes, int worker, int64_t y);

/** The next box of a worker's row, from *next on, that meets the node at x, as its number; SIZE_MAX = none.
 */
static inline size_t vxm_node_boxes_next(const vxm_node_boxes *boxes, int worker, int64_t x, size_t *next) {
  const uint32_t *row = boxes->row + (size_t)worker * boxes->count;
  while (*next < boxes->row_count[worker]) {
    uint32_t i = row[(*next)++];
    if (boxes->box[i][0][0] < x + VXM_NODE_SIDE && boxes->box[i][0][1] > x)
      return i;
  }
  return SIZE_MAX;
}

/**
 * Who makes values. Nodes are asked for in layers along z, one after the other; the rows of a layer by all
 * threads; the nodes of a row along x, by one.
 */
typedef struct vxm_node_maker {
  vxm_node_boxes *boxes; /**< begun with each layer and each row before its nodes; NULL = there are none */
  /**
   * Makes the values of the node whose first voxel is `at`.
   *
   * @param values room for all of them, x fastest and 16 to a row; those beyond the grid are not looked at
   * @return whether all have one value: then the first of them alone is there
   */
  bool (*make)(void *payload, int worker, const int64_t at[3], void *values);
  void *payload;
  const char *phase; /**< for progress */
} vxm_node_maker;

#endif
