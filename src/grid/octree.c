/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree.h"

#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

int vxm_octree_levels(const vxm_space *space) {
  int64_t most = vxm_max(space->dims[0], vxm_max(space->dims[1], space->dims[2]));
  int levels = 1;
  while (vxm_octree_side(levels) < most)
    levels++;
  return levels;
}

static void renew_serial(vxm_sparse *sparse) {
  static atomic_uint_fast64_t last_serial;
  sparse->serial = atomic_fetch_add(&last_serial, 1) + 1;
}

vxm_status vxm_octree_new(vxm_sparse **out, vxm_context *context, const vxm_space *space, vxm_error *error) {
  vxm_context *owner;
  *out = NULL;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  vxm_sparse *sparse = vxm_try_calloc(owner, 1, sizeof *sparse, &status, error);
  if (!sparse) {
    vxm_context_release(owner);
    return status;
  }
  sparse->context = owner;
  sparse->space = *space;
  sparse->levels = vxm_octree_levels(space);
  renew_serial(sparse);
  *out = sparse;
  return VXM_OK;
}

void vxm_sparse_destroy(vxm_sparse *sparse) {
  if (!sparse)
    return;
  vxm_context *context = sparse->context;
  for (int l = 0; l < sparse->levels; l++)
    vxm_free(context, sparse->nodes[l]);
  vxm_free(context, sparse->bricks);
  vxm_free(context, sparse);
  vxm_context_release(context);
}

uint64_t vxm_octree_box(const int64_t dims[3], const int64_t at[3]) {
  uint64_t bits = 0;
  for (int b = 0; b < 64; b++)
    bits |= (uint64_t)(at[0] + b % 4 < dims[0] && at[1] + b / 4 % 4 < dims[1] && at[2] + b / 16 < dims[2])
            << b;
  return bits;
}

uint64_t vxm_octree_brick(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k) {
  size_t index = 0;
  for (int l = sparse->levels - 1; l >= 0; l--) {
    const vxm_octree_node *node = &sparse->nodes[l][index];
    int shift = 2 * l + 2;
    unsigned child = vxm_octree_child((unsigned)(i >> shift), (unsigned)(j >> shift), (unsigned)(k >> shift));
    if (!(node->mixed >> child & 1))
      return node->full >> child & 1 ? ~UINT64_C(0) : 0;
    index = vxm_octree_index(node, child);
  }
  return sparse->bricks[index];
}

const vxm_octree_node *vxm_octree_below(const vxm_sparse *sparse, int level, const vxm_octree_node *node,
                                        int64_t i, int64_t j, int64_t k) {
  static const vxm_octree_node full = {.full = ~UINT64_C(0)}, empty = {.full = 0};
  int shift = 2 * level + 2;
  unsigned child = vxm_octree_child((unsigned)(i >> shift), (unsigned)(j >> shift), (unsigned)(k >> shift));
  if (!(node->mixed >> child & 1))
    return node->full >> child & 1 ? &full : &empty;
  return &sparse->nodes[level - 1][vxm_octree_index(node, child)];
}

const vxm_octree_node *vxm_octree_node_at(const vxm_sparse *sparse, int level, int64_t i, int64_t j,
                                          int64_t k) {
  const vxm_octree_node *node = sparse->nodes[sparse->levels - 1];
  for (int l = sparse->levels - 1; l > level; l--)
    node = vxm_octree_below(sparse, l, node, i, j, k);
  return node;
}

const vxm_octree_node *vxm_octree_low_node(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k) {
  return vxm_octree_node_at(sparse, 0, i, j, k);
}

void vxm_octree_set_bits(vxm_sparse *sparse, int64_t i, int64_t j, int64_t k, uint64_t bits) {
  const vxm_octree_node *node = vxm_octree_low_node(sparse, i, j, k);
  unsigned child = vxm_octree_child((unsigned)(i >> 2), (unsigned)(j >> 2), (unsigned)(k >> 2));
  if (!(node->mixed >> child & 1))
    return;
  sparse->bricks[vxm_octree_index(node, child)] |= bits;
  renew_serial(sparse);
}

bool vxm_octree_get(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k) {
  const int64_t *n = sparse->space.dims;
  if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2])
    return false;
  return vxm_octree_brick(sparse, i, j, k) >> vxm_octree_bit(i, j, k) & 1;
}

size_t vxm_octree_nodes(const vxm_sparse *sparse) {
  size_t count = 0;
  for (int l = 0; l < sparse->levels; l++)
    count += sparse->node_count[l];
  return count;
}

uint64_t vxm_octree_bytes(const vxm_sparse *sparse) {
  return offsetof(vxm_sparse, warnings) + vxm_octree_nodes(sparse) * sizeof(vxm_octree_node) +
         sparse->brick_count * sizeof *sparse->bricks;
}

/* ---- Walking ---- */

typedef struct walk {
  const vxm_sparse *sparse;
  const int64_t *begin, *end;
  vxm_sparse_fn function;
  void *payload;
} walk;

static void walk_node(const walk *w, int level, size_t index, const int64_t at[3]) {
  const vxm_octree_node *node = &w->sparse->nodes[level][index];
  size_t next = (size_t)node->first;
  int64_t side = vxm_octree_side(level);
  for (uint64_t left = node->mixed | node->full; left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    bool mixed = node->mixed >> child & 1;
    size_t below = next;
    next += mixed;
    vxm_sparse_piece piece = {.size = sizeof piece, .side = side, .bits = ~UINT64_C(0)};
    vxm_octree_child_at(piece.position, at, child, side);
    if (!vxm_cube_meets(piece.position, side, w->begin, w->end))
      continue;
    if (mixed && level > 0) {
      walk_node(w, level - 1, below, piece.position);
      continue;
    }
    if (mixed)
      piece.bits = w->sparse->bricks[below];
    w->function(&piece, w->payload);
  }
}

void vxm_octree_walk(const vxm_sparse *sparse, const int64_t begin[3], const int64_t end[3],
                     vxm_sparse_fn function, void *payload) {
  const walk w = {sparse, begin, end, function, payload};
  walk_node(&w, sparse->levels - 1, 0, (int64_t[3]){0, 0, 0});
}

void vxm_octree_walk_layers(const vxm_sparse *sparse, int axis, int64_t begin, int64_t end,
                            vxm_sparse_fn function, void *payload) {
  int64_t low[3] = {0, 0, 0}, high[3];
  memcpy(high, sparse->space.dims, sizeof high);
  low[axis] = begin;
  high[axis] = end;
  vxm_octree_walk(sparse, low, high, function, payload);
}
