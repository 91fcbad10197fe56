/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Count and hash of an octree. The hash follows the steps along x (grid/count_hash.h): each node is taken
 * together with the one before it along x, down to where both are uniform.
 */
#include "base/hash.h"
#include "base/threads.h"
#include "grid/count_hash.h"
#include "grid/octree.h"

#include <string.h>

enum { SHARE = 64, /**< voxels along z that a task sums, a multiple of a brick's */ STEPS = 256 };

/** A node, or what stands for it. */
typedef struct cell {
  enum { EMPTY, FULL, MIXED } kind;
  size_t index; /**< of a mixed one */
} cell;

typedef struct sums {
  const vxm_sparse *sparse;
  int64_t begin, end; /**< along z */
  vxm_count_hash sum;
  uint64_t ahead[64]; /**< numbers of a brick's voxels, from its first one on */
} sums;

static cell child_of(const vxm_sparse *sparse, int level, cell parent, unsigned child) {
  if (parent.kind != MIXED)
    return parent;
  const vxm_octree_node *node = &sparse->nodes[level][parent.index];
  if (node->mixed >> child & 1)
    return (cell){MIXED, vxm_octree_index(node, child)};
  return (cell){node->full >> child & 1 ? FULL : EMPTY, 0};
}

static uint64_t number_of(const sums *s, int64_t x, int64_t y, int64_t z) {
  const int64_t *n = s->sparse->space.dims;
  return (uint64_t)((z * n[1] + y) * n[0] + x);
}

/** Layers of a cell along z that are summed here. */
static int64_t layers_of(const sums *s, int64_t z, int64_t side) {
  return vxm_min(z + side, s->end) - vxm_max(z, s->begin);
}

/** Steps all over the face between an empty cell and a full one. */
static void add_face(sums *s, const int64_t at[3], int64_t side) {
  for (int64_t z = vxm_max(at[2], s->begin); z < vxm_min(at[2] + side, s->end); z++)
    for (int64_t y = at[1]; y < at[1] + side; y++)
      s->sum.hash += vxm_hash_word(0, number_of(s, at[0], y, z));
}

/** Bricks of a node of level 0, at 16 x + 4 z + y, and how many voxels they have. */
static int64_t expand(const vxm_sparse *sparse, cell node, uint64_t bricks[64]) {
  memset(bricks, node.kind == FULL ? 255 : 0, 64 * sizeof *bricks);
  if (node.kind != MIXED)
    return 0;
  const vxm_octree_node *children = &sparse->nodes[0][node.index];
  const uint64_t *from = sparse->bricks + children->first;
  int64_t voxels = 0;
  for (uint64_t left = children->mixed | children->full; left; left &= left - 1) {
    unsigned c = (unsigned)__builtin_ctzll(left);
    unsigned x = (c & 1) | (c >> 2 & 2), y = (c >> 1 & 1) | (c >> 3 & 2), z = (c >> 2 & 1) | (c >> 4 & 2);
    uint64_t bits = children->mixed >> c & 1 ? *from++ : ~UINT64_C(0);
    bricks[16 * x + 4 * z + y] = bits;
    voxels += vxm_popcount(bits);
  }
  return voxels;
}

/** The last bricks of a node of level 0 along x, at 4 z + y. */
static void last_bricks(const vxm_sparse *sparse, cell node, uint64_t bricks[16]) {
  for (unsigned r = 0; r < 16; r++) {
    cell brick = child_of(sparse, 0, node, vxm_octree_child(3, r % 4, r / 4));
    bricks[r] = brick.kind == MIXED ? sparse->bricks[brick.index] : brick.kind == FULL ? ~UINT64_C(0) : 0;
  }
}

/** Steps within a node of level 0, and to it from the one before it. */
static void sum_low(sums *s, cell left, cell node, const int64_t at[3]) {
  uint64_t bricks[64], before[16];
  int64_t beyond = at[0] + 16 - s->sparse->space.dims[0];
  s->sum.count += expand(s->sparse, node, bricks);
  last_bricks(s->sparse, left, before);
  for (unsigned b = 0; b < 64; b++) {
    uint64_t bits = bricks[b], last = b < 16 ? before[b] : bricks[b - 16];
    uint64_t steps =
        bits ^ ((bits << 1 & UINT64_C(0xeeeeeeeeeeeeeeee)) | (last >> 3 & UINT64_C(0x1111111111111111)));
    int64_t x = b / 16 * 4;
    if (x + beyond > 12) /* the step behind the last voxel is none */
      steps &= UINT64_C(0x1111111111111111) * vxm_low_bits((unsigned)vxm_max(16 - beyond - x, 0));
    if (steps == 0)
      continue;
    uint64_t first = number_of(s, at[0] + x, at[1] + b % 4 * 4, at[2] + b / 4 % 4 * 4);
    for (; steps; steps &= steps - 1)
      s->sum.hash += vxm_hash_word(0, first + s->ahead[__builtin_ctzll(steps)]);
  }
}

/** Voxels of a node of a level, steps within it and to it from the one before it along x, which lies as it
 * does. */
static void sum_node(sums *s, int level, cell left, cell node, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level + 1);
  if (at[0] >= s->sparse->space.dims[0] || layers_of(s, at[2], side) <= 0)
    return;
  if (node.kind != MIXED && left.kind != MIXED) {
    if (node.kind != left.kind)
      add_face(s, at, side);
    return;
  }
  if (level == 0) {
    sum_low(s, left, node, at);
    return;
  }
  side /= 4;
  for (unsigned r = 0; r < 16; r++) {
    cell last = child_of(s->sparse, level, left, vxm_octree_child(3, r % 4, r / 4));
    for (unsigned x = 0; x < 4; x++) {
      cell child = child_of(s->sparse, level, node, vxm_octree_child(x, r % 4, r / 4));
      const int64_t below[3] = {at[0] + x * side, at[1] + r % 4 * side, at[2] + r / 4 * side};
      if (node.kind == MIXED && child.kind == FULL)
        s->sum.count += side * side * vxm_max(layers_of(s, below[2], side), 0);
      if (child.kind == MIXED || last.kind != child.kind)
        sum_node(s, level - 1, last, child, below);
      last = child;
    }
  }
}

typedef struct sum_job {
  const vxm_sparse *sparse;
  size_t tasks;
  vxm_count_hash parts[STEPS];
} sum_job;

static void sum_share(size_t task, int worker, void *payload) {
  (void)worker;
  sum_job *job = payload;
  const vxm_sparse *sparse = job->sparse;
  size_t shares = ((size_t)sparse->space.dims[2] + SHARE - 1) / SHARE;
  sums s = {.sparse = sparse,
            .begin = (int64_t)vxm_slice_begin(shares, job->tasks, task) * SHARE,
            .end = (int64_t)vxm_slice_begin(shares, job->tasks, task + 1) * SHARE};
  for (unsigned b = 0; b < 64; b++)
    s.ahead[b] = number_of(&s, b % 4, b / 4 % 4, b / 16);
  const int64_t origin[3] = {0, 0, 0};
  int top = sparse->levels - 1;
  int64_t side = vxm_octree_side(top + 1);
  /* What lies before the grid is empty; a root all full is a cell of its own kind. */
  cell root = {sparse->nodes[top][0].full == ~UINT64_C(0) ? FULL : MIXED, 0};
  if (root.kind == FULL)
    s.sum.count += side * side * vxm_max(layers_of(&s, 0, side), 0);
  sum_node(&s, top, (cell){EMPTY, 0}, root, origin);
  job->parts[task] = s.sum;
}

void vxm_octree_count_hash(const vxm_sparse *sparse, int64_t *count, uint64_t *hash) {
  sum_job job = {.sparse = sparse};
  size_t shares = ((size_t)sparse->space.dims[2] + SHARE - 1) / SHARE;
  job.tasks = shares < STEPS ? shares : STEPS;
  vxm_parallel(sparse->context, job.tasks, sum_share, &job);
  vxm_count_hash sum = vxm_count_hash_start(&sparse->space);
  for (size_t t = 0; t < job.tasks; t++)
    vxm_count_hash_join(&sum, job.parts[t]);
  *count = sum.count;
  *hash = sum.hash;
}
