/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/node_values.h"

/* ---- Bits ---- */

/** Puts a brick's 16 rows of four voxels to those of its node. */
static void put_brick(uint64_t *rows, const int64_t place[3], uint64_t bits) {
  uint64_t *to = rows + 4 * (VXM_NODE_SIDE * place[2] + place[1]);
  for (int z = 0; z < 4; z++)
    for (int y = 0; y < 4; y++, bits >>= 4)
      to[VXM_NODE_SIDE * z + y] |= (bits & 15) << 4 * place[0];
}

bool vxm_node_bits(uint64_t rows[VXM_NODE_SIDE * VXM_NODE_SIDE], const vxm_sparse *sparse,
                   const int64_t at[3]) {
  const vxm_octree_node *node = vxm_octree_low_node(sparse, at[0], at[1], at[2]);
  bool alike = node->mixed == 0 && (node->full == 0 || node->full == ~UINT64_C(0));
  for (int r = 0; r < VXM_NODE_SIDE * VXM_NODE_SIDE; r++)
    rows[r] = alike && node->full ? vxm_low_bits(VXM_NODE_SIDE) : 0;
  for (uint64_t left = alike ? 0 : node->mixed | node->full; left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    int64_t place[3];
    vxm_octree_place(child, place);
    put_brick(rows, place,
              node->full >> child & 1 ? ~UINT64_C(0) : sparse->bricks[vxm_octree_index(node, child)]);
  }
  return alike;
}

/* ---- Boxes ---- */

vxm_status vxm_node_boxes_create(vxm_node_boxes *out, vxm_context *context, size_t count, vxm_error *error) {
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_status status = VXM_OK;
  *out = (vxm_node_boxes){.context = context, .count = count};
  out->box = vxm_try_alloc(context, count, sizeof *out->box, &status, error);
  out->layer = vxm_try_alloc(context, count, sizeof *out->layer, &status, error);
  out->row = vxm_try_alloc(context, workers * count, sizeof *out->row, &status, error);
  out->row_count = vxm_try_calloc(context, workers, sizeof *out->row_count, &status, error);
  return status;
}

void vxm_node_boxes_destroy(vxm_node_boxes *boxes) {
  vxm_free(boxes->context, boxes->box);
  vxm_free(boxes->context, boxes->layer);
  vxm_free(boxes->context, boxes->row);
  vxm_free(boxes->context, boxes->row_count);
  *boxes = (vxm_node_boxes){.context = boxes->context};
}

uint64_t vxm_node_boxes_bytes(size_t count, int workers) {
  return (uint64_t)count * (sizeof(int32_t[3][2]) + (1 + (uint64_t)workers) * sizeof(uint32_t)) +
         (uint64_t)workers * sizeof(size_t);
}

/** Whether a box has voxels of a node's extent from `at` on, along an axis. */
static bool reaches(const vxm_node_boxes *boxes, size_t i, int axis, int64_t at) {
  return boxes->box[i][axis][0] < at + VXM_NODE_SIDE && boxes->box[i][axis][1] > at;
}

void vxm_node_boxes_begin_layer(vxm_node_boxes *boxes, int64_t z) {
  boxes->layer_count = 0;
  for (size_t i = 0; i < boxes->count; i++)
    if (reaches(boxes, i, 2, z))
      boxes->layer[boxes->layer_count++] = (uint32_t)i;
}

void vxm_node_boxes_begin_row(vxm_node_boxes *boxes, int worker, int64_t y) {
  uint32_t *row = boxes->row + (size_t)worker * boxes->count;
  size_t count = 0;
  for (size_t n = 0; n < boxes->layer_count; n++)
    if (reaches(boxes, boxes->layer[n], 1, y))
      row[count++] = boxes->layer[n];
  boxes->row_count[worker] = count;
}
