/* SPDX-License-Identifier: BSD-3-Clause */
/** Set operations: both octrees are walked together, and what is made comes out in Morton order. */
#include "grid/octree_growth.h"

/** A node of an operand or a brick, or what stands for it. */
typedef struct cell {
  enum { EMPTY, FULL, MIXED, BOX /**< the whole box, as far as it reaches */ } kind;
  size_t index; /**< of a mixed one */
} cell;

/** The children of a cell: surely full, and perhaps not empty. */
typedef struct bounds {
  uint64_t low, high;
} bounds;

typedef struct combination {
  const vxm_sparse *operand[2]; /**< NULL for a box */
  vxm_octree_growth result;
  vxm_set_operation op;
} combination;

static bounds apply(vxm_set_operation op, bounds a, bounds b) {
  switch (op) {
  case VXM_SET_UNION:
    return (bounds){a.low | b.low, a.high | b.high};
  case VXM_SET_INTERSECTION:
    return (bounds){a.low & b.low, a.high & b.high};
  case VXM_SET_SYMMETRIC_DIFFERENCE:
    return (bounds){(a.low & ~b.high) | (b.low & ~a.high), (a.high & ~b.low) | (b.high & ~a.low)};
  default: /* the complement is the difference of the box and the set */
    return (bounds){a.low & ~b.high, a.high & ~b.low};
  }
}

/** The children that lie before a place along an axis; by place and axis. */
static const uint64_t before[5][3] = {
    {0, 0, 0},
    {UINT64_C(0x0055005500550055), UINT64_C(0x0000333300003333), UINT64_C(0x000000000f0f0f0f)},
    {UINT64_C(0x00ff00ff00ff00ff), UINT64_C(0x0000ffff0000ffff), UINT64_C(0x00000000ffffffff)},
    {UINT64_C(0x55ff55ff55ff55ff), UINT64_C(0x3333ffff3333ffff), UINT64_C(0x0f0f0f0fffffffff)},
    {UINT64_MAX, UINT64_MAX, UINT64_MAX}};

/** The children that the box holds, and those that it meets. */
static bounds box_in(const combination *c, int level, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level);
  bounds box = {UINT64_MAX, UINT64_MAX};
  for (int a = 0; a < 3; a++) {
    int64_t left = vxm_max(c->result.sparse->space.dims[a] - at[a], 0);
    box.low &= before[vxm_min(left / side, 4)][a];
    box.high &= before[vxm_min((left + side - 1) / side, 4)][a];
  }
  return box;
}

static bounds children_of(const combination *c, int which, int level, cell parent, const int64_t at[3]) {
  if (parent.kind == BOX)
    return box_in(c, level, at);
  if (parent.kind != MIXED)
    return parent.kind == FULL ? (bounds){UINT64_MAX, UINT64_MAX} : (bounds){0, 0};
  const vxm_octree_node *node = &c->operand[which]->nodes[level][parent.index];
  return (bounds){node->full, node->full | node->mixed};
}

/** One of the children of a parent, of which all is known. */
static cell child_of(const combination *c, int which, int level, cell parent, bounds children,
                     unsigned child) {
  if (children.low >> child & 1)
    return (cell){FULL, 0};
  if (!(children.high >> child & 1))
    return (cell){EMPTY, 0};
  if (parent.kind == BOX)
    return parent;
  return (cell){MIXED, vxm_octree_index(&c->operand[which]->nodes[level][parent.index], child)};
}

static bounds bits_of(const combination *c, int which, cell brick, const int64_t at[3]) {
  uint64_t bits = brick.kind == FULL ? UINT64_MAX : 0;
  if (brick.kind == MIXED)
    bits = c->operand[which]->bricks[brick.index];
  if (brick.kind == BOX)
    bits = vxm_octree_box(c->result.sparse->space.dims, at);
  return (bounds){bits, bits};
}

/** The operand that alone says what two cells make together: the other is all alike there. -1 = none. */
static int deciding(vxm_set_operation op, cell a, cell b) {
  int neutral = op == VXM_SET_INTERSECTION ? FULL : EMPTY;
  if (a.kind == MIXED && (int)b.kind == neutral)
    return 0;
  bool same = op == VXM_SET_UNION || op == VXM_SET_INTERSECTION || op == VXM_SET_SYMMETRIC_DIFFERENCE;
  return same && b.kind == MIXED && (int)a.kind == neutral ? 1 : -1;
}

/** Two nodes of a level at the same place. */
static vxm_octree_state combine_nodes(combination *c, int level, cell a, cell b, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level);
  int which = deciding(c->op, a, b);
  if (which >= 0)
    return vxm_octree_growth_copy(&c->result, c->operand[which], level, which == 0 ? a.index : b.index);
  size_t first = vxm_octree_growth_next(&c->result, level);
  bounds p = children_of(c, 0, level, a, at), q = children_of(c, 1, level, b, at), all = apply(c->op, p, q);
  uint64_t mixed = 0, full = all.low;
  for (uint64_t open = all.high & ~all.low; open && c->result.status == VXM_OK; open &= open - 1) {
    unsigned child = (unsigned)__builtin_ctzll(open);
    int64_t below[3];
    vxm_octree_child_at(below, at, child, side);
    cell x = child_of(c, 0, level, a, p, child), y = child_of(c, 1, level, b, q, child);
    vxm_octree_state made =
        level > 0 ? combine_nodes(c, level - 1, x, y, below)
                  : vxm_octree_growth_brick(
                        &c->result, apply(c->op, bits_of(c, 0, x, below), bits_of(c, 1, y, below)).low);
    mixed |= (uint64_t)(made == VXM_OCTREE_MIXED) << child;
    full |= (uint64_t)(made == VXM_OCTREE_FULL) << child;
  }
  return vxm_octree_growth_node(&c->result, level, mixed, full, first);
}

vxm_status vxm_octree_combine(vxm_sparse **out, const vxm_sparse *a, const vxm_sparse *b,
                              vxm_set_operation op, vxm_error *error) {
  combination c = {.operand = {a, b}, .op = op};
  cell root = {MIXED, 0}, first = root;
  if (op == VXM_SET_COMPLEMENT) {
    c.operand[1] = a;
    first.kind = BOX;
  }
  vxm_octree_growth_begin(&c.result, a->context, &a->space, error);
  if (op == VXM_SET_UNION)
    vxm_octree_growth_reserve(&c.result, a, b);
  if (c.result.status == VXM_OK)
    combine_nodes(&c, c.result.sparse->levels - 1, first, root, (int64_t[3]){0, 0, 0});
  return vxm_octree_growth_end(out, &c.result);
}
