/* SPDX-License-Identifier: BSD-3-Clause */
/** Set operations: both octrees are walked together, and what is made comes out in Morton order. */
#include "grid/octree.h"

#include <string.h>

/** A child of a node, or what stands for it. */
typedef struct cell {
  enum { EMPTY, FULL, MIXED, BOX /**< the whole box, as far as it reaches */ } kind;
  size_t index; /**< of a mixed one */
} cell;

typedef struct combination {
  const vxm_sparse *operand[2]; /**< NULL for a box */
  vxm_sparse *result;
  size_t node_capacity[VXM_OCTREE_LEVELS], brick_capacity;
  vxm_set_operation op;
  vxm_status status;
  vxm_error *error;
} combination;

static uint64_t apply(vxm_set_operation op, uint64_t a, uint64_t b) {
  switch (op) {
  case VXM_SET_UNION:
    return a | b;
  case VXM_SET_INTERSECTION:
    return a & b;
  case VXM_SET_SYMMETRIC_DIFFERENCE:
    return a ^ b;
  default: /* the complement is the difference of the box and the set */
    return a & ~b;
  }
}

/** The part of the box in a cube: all of it, nothing or some. */
static cell box_in(const combination *c, const int64_t at[3], int64_t side) {
  const int64_t *n = c->result->space.dims;
  bool inside = true, outside = false;
  for (int a = 0; a < 3; a++) {
    inside &= at[a] + side <= n[a];
    outside |= at[a] >= n[a];
  }
  return (cell){outside ? EMPTY : inside ? FULL : BOX, 0};
}

static cell child_of(const combination *c, int which, int level, cell parent, unsigned child,
                     const int64_t at[3]) {
  if (parent.kind == BOX)
    return box_in(c, at, vxm_octree_side(level));
  if (parent.kind != MIXED)
    return parent;
  const vxm_octree_node *node = &c->operand[which]->nodes[level][parent.index];
  if (node->mixed >> child & 1)
    return (cell){MIXED, vxm_octree_index(node, child)};
  return (cell){node->full >> child & 1 ? FULL : EMPTY, 0};
}

static uint64_t bits_of(const combination *c, int which, cell brick, const int64_t at[3]) {
  if (brick.kind == MIXED)
    return c->operand[which]->bricks[brick.index];
  if (brick.kind != BOX)
    return brick.kind == FULL ? ~UINT64_C(0) : 0;
  uint64_t bits = 0;
  for (int b = 0; b < 64; b++) {
    const int64_t voxel[3] = {at[0] + b % 4, at[1] + b / 4 % 4, at[2] + b / 16};
    bits |= (uint64_t)(box_in(c, voxel, 1).kind == FULL) << b;
  }
  return bits;
}

/** The result if both cells are uniform, or one of them alone decides; else MIXED. */
static cell decide(vxm_set_operation op, cell a, cell b) {
  uint64_t low = UINT64_MAX, high = 0;
  for (int p = 0; p < 2; p++)
    for (int q = 0; q < 2; q++) {
      bool a_may = a.kind == (p ? FULL : EMPTY) || a.kind > FULL;
      bool b_may = b.kind == (q ? FULL : EMPTY) || b.kind > FULL;
      if (!a_may || !b_may)
        continue;
      uint64_t value = apply(op, p ? UINT64_MAX : 0, q ? UINT64_MAX : 0);
      low &= value;
      high |= value;
    }
  return (cell){low == high ? (low ? FULL : EMPTY) : MIXED, 0};
}

static cell add_brick(combination *c, uint64_t bits) {
  vxm_sparse *result = c->result;
  if (bits == 0 || bits == ~UINT64_C(0) || c->status != VXM_OK)
    return (cell){bits ? FULL : EMPTY, 0};
  c->status = vxm_grow(result->context, (void **)&result->bricks, &c->brick_capacity, result->brick_count + 1,
                       sizeof *result->bricks, c->error);
  if (c->status == VXM_OK)
    result->bricks[result->brick_count++] = bits;
  return (cell){MIXED, 0};
}

static cell add_node(combination *c, int level, vxm_octree_node node, bool always) {
  vxm_sparse *result = c->result;
  if (c->status != VXM_OK)
    return (cell){EMPTY, 0};
  if (!always && node.mixed == 0 && (node.full == 0 || node.full == ~UINT64_C(0)))
    return (cell){node.full ? FULL : EMPTY, 0};
  c->status = vxm_grow(result->context, (void **)&result->nodes[level], &c->node_capacity[level],
                       result->node_count[level] + 1, sizeof *result->nodes[level], c->error);
  if (c->status == VXM_OK)
    result->nodes[level][result->node_count[level]++] = node;
  return (cell){MIXED, 0};
}

/** Two nodes of a level at the same place. */
static cell combine_nodes(combination *c, int level, cell a, cell b, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level);
  size_t first = level > 0 ? c->result->node_count[level - 1] : c->result->brick_count;
  vxm_octree_node node = {0, 0, 0};
  for (unsigned child = 0; child < 64 && c->status == VXM_OK; child++) {
    int64_t below[3];
    vxm_octree_place(child, below);
    for (int i = 0; i < 3; i++)
      below[i] = at[i] + below[i] * side;
    cell p = child_of(c, 0, level, a, child, below), q = child_of(c, 1, level, b, child, below);
    cell made = decide(c->op, p, q);
    if (made.kind == MIXED && level > 0)
      made = combine_nodes(c, level - 1, p, q, below);
    else if (made.kind == MIXED)
      made = add_brick(c, apply(c->op, bits_of(c, 0, p, below), bits_of(c, 1, q, below)));
    node.mixed |= (uint64_t)(made.kind == MIXED) << child;
    node.full |= (uint64_t)(made.kind == FULL) << child;
  }
  node.first = node.mixed ? first : 0;
  return add_node(c, level, node, level == c->result->levels - 1);
}

vxm_status vxm_octree_combine(vxm_sparse **out, const vxm_sparse *a, const vxm_sparse *b,
                              vxm_set_operation op, vxm_error *error) {
  combination c = {.operand = {a, b}, .op = op, .error = error};
  vxm_status status = vxm_octree_new(&c.result, a->context, &a->space, error);
  *out = NULL;
  if (status != VXM_OK)
    return status;
  cell root = {MIXED, 0}, first = root;
  if (op == VXM_SET_COMPLEMENT) {
    c.operand[1] = a;
    first.kind = BOX;
  }
  combine_nodes(&c, c.result->levels - 1, first, root, (int64_t[3]){0, 0, 0});
  if (c.status != VXM_OK) {
    vxm_sparse_destroy(c.result);
    return c.status;
  }
  *out = c.result;
  return VXM_OK;
}
