/* SPDX-License-Identifier: BSD-3-Clause */
/** Which of many boxes hold another one, one after the other in their order. */
#ifndef VXM_MESH_BOX_TREE_H
#define VXM_MESH_BOX_TREE_H

#include "base/context.h"

#define VXM_NO_BOX UINT32_MAX

/** About some boxes, those of two branches or a leaf's. */
typedef struct vxm_box_node {
  double box[6];        /**< low above high if it has none */
  uint32_t first, last; /**< of the numbers of its boxes */
} vxm_box_node;

/**
 * A tree over boxes by the six numbers of each, so that boxes that differ in any of them come apart, even if
 * all lie about one point. A search takes the branches by the lowest number in them, so that it need not look
 * at what comes after the last box that is asked for.
 */
typedef struct vxm_box_tree {
  vxm_context *context;
  const double (*boxes)[6]; /**< x, y, z from and to, none of them NaN; the caller's */
  size_t count, leaves;     /**< leaves: a power of 2; nodes 1 to 2 leaves - 1, i above 2 i and 2 i + 1 */
  uint32_t *order;          /**< numbers of boxes by leaf */
  vxm_box_node *nodes;
  uint64_t *heap; /**< of the search: what may hold the box, by the number at which it begins */
  size_t heap_count;
  double inner[6];
  uint32_t from;
  uint64_t looked_at; /**< nodes and boxes, by all searches so far */
} vxm_box_tree;

/** @param count below VXM_NO_BOX @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT; then it is empty
 */
vxm_status vxm_box_tree_build(vxm_box_tree *out, vxm_context *context, const double (*boxes)[6], size_t count,
                              vxm_error *error);
void vxm_box_tree_destroy(vxm_box_tree *tree);

/** Begins a search for the boxes whose number is `from` or above, and that `box` does not reach out of. */
void vxm_box_tree_search(vxm_box_tree *tree, const double box[6], size_t from);
/** The next one by number, or VXM_NO_BOX. */
uint32_t vxm_box_tree_next(vxm_box_tree *tree);

#endif
