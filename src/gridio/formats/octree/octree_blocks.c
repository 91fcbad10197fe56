/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octree/octree_blocks.h"

typedef struct walk {
  vxm_octree_node *const *nodes;
  int tile_level;
  const int64_t *begin, *end;
  vxm_octree_block_fn function;
  void *payload;
  uint64_t number; /**< of the next block */
  bool is_ended;
} walk;

static bool meets(const walk *w, const int64_t at[3], int64_t side) {
  return !w->is_ended && vxm_cube_meets(at, side, w->begin, w->end);
}

static void add_block(walk *w, const int64_t at[3]) {
  if (meets(w, at, vxm_octree_side(w->tile_level + 1)))
    w->is_ended = !w->function(w->number, at, w->payload);
  w->number++;
}

/** A full cube, whose children would be nodes of a level. */
static void add_full(walk *w, int level, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level);
  if (level == w->tile_level) {
    add_block(w, at);
    return;
  }
  if (!meets(w, at, 4 * side)) {
    w->number += UINT64_C(1) << 6 * (level - w->tile_level);
    return;
  }
  for (unsigned child = 0; child < 64; child++) {
    int64_t place[3];
    vxm_octree_child_at(place, at, child, side);
    add_full(w, level - 1, place);
  }
}

static void walk_node(walk *w, int level, size_t index, const int64_t at[3]) {
  if (level == w->tile_level) {
    add_block(w, at);
    return;
  }
  const vxm_octree_node *node = &w->nodes[level][index];
  int64_t side = vxm_octree_side(level);
  for (uint64_t left = node->mixed | node->full; left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    int64_t place[3];
    vxm_octree_child_at(place, at, child, side);
    if (node->full >> child & 1)
      add_full(w, level - 1, place);
    else
      walk_node(w, level - 1, vxm_octree_index(node, child), place);
  }
}

uint64_t vxm_octree_each_block(vxm_octree_node *const nodes[VXM_OCTREE_LEVELS], int levels,
                               const int64_t begin[3], const int64_t end[3], vxm_octree_block_fn function,
                               void *payload) {
  walk w = {.nodes = nodes,
            .tile_level = vxm_octree_tile_level(levels),
            .begin = begin,
            .end = end,
            .function = function,
            .payload = payload};
  const vxm_octree_node *root = &nodes[levels - 1][0];
  if (root->mixed | root->full)
    walk_node(&w, levels - 1, 0, (int64_t[3]){0, 0, 0});
  return w.number;
}

vxm_octree_part vxm_octree_part_at(const vxm_sparse *sparse, int level, const int64_t at[3]) {
  vxm_octree_part part = {VXM_OCTREE_MIXED, 0};
  for (int l = sparse->levels - 1; l > level; l--) {
    int shift = 2 * l + 2;
    part = vxm_octree_child_part(
        sparse, l, part,
        vxm_octree_child((unsigned)(at[0] >> shift), (unsigned)(at[1] >> shift), (unsigned)(at[2] >> shift)));
  }
  return part;
}
