/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/box_tree.h"

#include "mesh/sort.h"

#include <math.h>
#include <string.h>

enum { LEAF = 8, KEY_BITS = 64, SIDES = 6 };

/* ---- Building ---- */

/** Bits that grow with a number, from its 32-bit float. */
static uint32_t ordered_bits(double number) {
  float single = (float)number;
  uint32_t bits;
  memcpy(&bits, &single, sizeof bits);
  return bits >> 31 ? ~bits : bits | (uint32_t)1 << 31;
}

static unsigned bits_for(size_t count) {
  unsigned bits = 1;
  while (count >> bits)
    bits++;
  return bits;
}

/** Boxes in the order of a curve through the six dimensions of their sides. A box stands in it where each
 * side stands among those of all boxes, not by the length of anything, so that boxes of any scale come apart.
 */
static void order_boxes(vxm_box_tree *tree, uint64_t *places, uint64_t *keys, uint64_t *scratch) {
  const unsigned number_bits = bits_for(tree->count), digits = (KEY_BITS - number_bits) / SIDES;
  for (size_t i = 0; i < tree->count; i++)
    places[i] = 0;
  for (unsigned side = 0; side < SIDES; side++) {
    for (size_t i = 0; i < tree->count; i++)
      keys[i] = (uint64_t)ordered_bits(tree->boxes[i][side]) << 32 | i;
    vxm_sort_keys(keys, scratch, tree->count);
    for (size_t k = 0; k < tree->count; k++) {
      uint64_t place = ((uint64_t)k << digits) / tree->count;
      for (unsigned d = 0; d < digits; d++)
        places[keys[k] & UINT32_MAX] |= (place >> d & 1) << (SIDES * d + side);
    }
  }
  for (size_t i = 0; i < tree->count; i++)
    keys[i] = places[i] << number_bits | i;
  vxm_sort_keys(keys, scratch, tree->count);
  for (size_t i = 0; i < tree->count; i++)
    tree->order[i] = (uint32_t)(keys[i] & (((uint64_t)1 << number_bits) - 1));
}

static void include(vxm_box_node *node, const double box[6], uint32_t first, uint32_t last) {
  for (int a = 0; a < 3; a++) {
    node->box[a] = fmin(node->box[a], box[a]);
    node->box[a + 3] = fmax(node->box[a + 3], box[a + 3]);
  }
  node->first = first < node->first ? first : node->first;
  node->last = last > node->last ? last : node->last;
}

static void make_nodes(vxm_box_tree *tree) {
  static const vxm_box_node none = {
      {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}, VXM_NO_BOX, 0};
  for (size_t n = 1; n < 2 * tree->leaves; n++)
    tree->nodes[n] = none;
  for (size_t i = 0; i < tree->count; i++)
    include(&tree->nodes[tree->leaves + i / LEAF], tree->boxes[tree->order[i]], tree->order[i],
            tree->order[i]);
  for (size_t n = 2 * tree->leaves - 1; n > 1; n--)
    include(&tree->nodes[n / 2], tree->nodes[n].box, tree->nodes[n].first, tree->nodes[n].last);
}

vxm_status vxm_box_tree_build(vxm_box_tree *out, vxm_context *context, const double (*boxes)[6], size_t count,
                              vxm_error *error) {
  vxm_status status = VXM_OK;
  *out = (vxm_box_tree){.context = context, .boxes = boxes, .count = count, .leaves = 1};
  while (out->leaves * LEAF < count)
    out->leaves *= 2;
  uint64_t *places = vxm_try_alloc(context, count, sizeof *places, &status, error);
  uint64_t *keys = places ? vxm_try_alloc(context, count, sizeof *keys, &status, error) : NULL;
  out->order = keys ? vxm_try_alloc(context, count, sizeof *out->order, &status, error) : NULL;
  out->heap = out->order ? vxm_try_alloc(context, count + 1, sizeof *out->heap, &status, error) : NULL;
  if (out->heap)
    order_boxes(out, places, keys, out->heap);
  vxm_free(context, keys);
  vxm_free(context, places);
  if (out->heap)
    out->nodes = vxm_try_alloc(context, 2 * out->leaves, sizeof *out->nodes, &status, error);
  if (out->nodes) {
    make_nodes(out);
    return VXM_OK;
  }
  vxm_box_tree_destroy(out);
  return status;
}

void vxm_box_tree_destroy(vxm_box_tree *tree) {
  if (!tree->context)
    return;
  vxm_free(tree->context, tree->nodes);
  vxm_free(tree->context, tree->heap);
  vxm_free(tree->context, tree->order);
  *tree = (vxm_box_tree){0};
}

/* ---- Searching ---- */

/** In the lower half of an entry of the heap: it is the box that the upper half tells, rather than a node. */
enum { IS_BOX = 0 };

/** Whether `inner` does not reach out of a box. */
static bool is_within(const double inner[6], const double box[6]) {
  for (int a = 0; a < 3; a++)
    if (!(inner[a] >= box[a]) || !(inner[a + 3] <= box[a + 3]))
      return false;
  return true;
}

/** Entries stand for boxes that no other entry stands for, so there are no more of them than boxes. */
static void push(vxm_box_tree *tree, uint32_t number, uint32_t node) {
  uint64_t entry = (uint64_t)number << 32 | node;
  size_t at = ++tree->heap_count;
  for (; at > 1 && tree->heap[at / 2] > entry; at /= 2)
    tree->heap[at] = tree->heap[at / 2];
  tree->heap[at] = entry;
}

static uint64_t pop(vxm_box_tree *tree) {
  uint64_t least = tree->heap[1], last = tree->heap[tree->heap_count--];
  size_t at = 1;
  for (size_t next = 2; next <= tree->heap_count; next = 2 * at) {
    if (next < tree->heap_count && tree->heap[next + 1] < tree->heap[next])
      next++;
    if (tree->heap[next] >= last)
      break;
    tree->heap[at] = tree->heap[next];
    at = next;
  }
  tree->heap[at] = last;
  return least;
}

static void push_node(vxm_box_tree *tree, uint32_t node) {
  const vxm_box_node *n = &tree->nodes[node];
  tree->looked_at++;
  if (n->first <= n->last && n->last >= tree->from && is_within(tree->inner, n->box))
    push(tree, n->first, node);
}

static void push_boxes(vxm_box_tree *tree, size_t leaf) {
  size_t begin = leaf * LEAF, end = begin + LEAF < tree->count ? begin + LEAF : tree->count;
  for (size_t i = begin; i < end; i++) {
    uint32_t number = tree->order[i];
    tree->looked_at++;
    if (number >= tree->from && is_within(tree->inner, tree->boxes[number]))
      push(tree, number, IS_BOX);
  }
}

void vxm_box_tree_search(vxm_box_tree *tree, const double box[6], size_t from) {
  memcpy(tree->inner, box, sizeof tree->inner);
  tree->from = (uint32_t)from;
  tree->heap_count = 0;
  push_node(tree, 1);
}

uint32_t vxm_box_tree_next(vxm_box_tree *tree) {
  while (tree->heap_count > 0) {
    uint64_t entry = pop(tree);
    uint32_t node = (uint32_t)(entry & UINT32_MAX);
    if (node == IS_BOX)
      return (uint32_t)(entry >> 32);
    if (node >= tree->leaves)
      push_boxes(tree, node - tree->leaves);
    else {
      push_node(tree, 2 * node);
      push_node(tree, 2 * node + 1);
    }
  }
  return VXM_NO_BOX;
}
