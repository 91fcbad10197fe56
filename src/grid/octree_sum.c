/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Count and hash of an octree. The hash follows the steps along x (grid/sum.h): those within bricks, and
 * those between neighbours along x, down to where both are uniform.
 */
#include "base/hash.h"
#include "base/threads.h"
#include "grid/octree.h"
#include "grid/sum.h"

enum { SHARE = 64, /**< voxels along z that a task sums, a multiple of a brick's */ STEPS = 256 };

/** A child of a node, or what stands for it. */
typedef struct cell {
  enum { EMPTY, FULL, MIXED } kind;
  size_t index; /**< of a mixed one */
} cell;

typedef struct sums {
  const vxm_sparse *sparse;
  int64_t begin, end; /**< along z */
  vxm_sum sum;
} sums;

static cell child_of(const vxm_sparse *sparse, int level, cell parent, unsigned child) {
  if (parent.kind != MIXED)
    return parent;
  const vxm_octree_node *node = &sparse->nodes[level][parent.index];
  if (node->mixed >> child & 1)
    return (cell){MIXED, vxm_octree_index(node, child)};
  return (cell){node->full >> child & 1 ? FULL : EMPTY, 0};
}

static inline void add_step(sums *s, int64_t x, int64_t y, int64_t z) {
  const int64_t *n = s->sparse->space.dims;
  s->sum.hash += vxm_hash_word(0, (uint64_t)((z * n[1] + y) * n[0] + x));
}

/** Steps at the voxels of a brick given by bits. */
static inline void add_steps(sums *s, uint64_t steps, const int64_t at[3]) {
  for (; steps; steps &= steps - 1) {
    int b = __builtin_ctzll(steps);
    add_step(s, at[0] + b % 4, at[1] + b / 4 % 4, at[2] + b / 16);
  }
}

/** Bits of a cell that is a brick. */
static uint64_t bits_of(const vxm_sparse *sparse, cell brick) {
  return brick.kind == MIXED ? sparse->bricks[brick.index] : brick.kind == FULL ? ~UINT64_C(0) : 0;
}

/** Steps from a cell to the one behind it, which begins at `at`; both are children of nodes of a level. */
static void sum_between(sums *s, int level, cell left, cell right, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level);
  if (at[0] >= s->sparse->space.dims[0] || at[2] >= s->end || at[2] + side <= s->begin ||
      (left.kind == right.kind && left.kind != MIXED))
    return;
  if (left.kind != MIXED && right.kind != MIXED) {
    for (int64_t z = vxm_max(at[2], s->begin); z < vxm_min(at[2] + side, s->end); z++)
      for (int64_t y = at[1]; y < at[1] + side; y++)
        add_step(s, at[0], y, z);
    return;
  }
  if (level == 0) {
    uint64_t steps = bits_of(s->sparse, left) >> 3 ^ bits_of(s->sparse, right);
    add_steps(s, steps & UINT64_C(0x1111111111111111), at);
    return;
  }
  for (unsigned r = 0; r < 16; r++) {
    cell a = child_of(s->sparse, level - 1, left, vxm_octree_child(3, r % 4, r / 4));
    cell b = child_of(s->sparse, level - 1, right, vxm_octree_child(0, r % 4, r / 4));
    const int64_t below[3] = {at[0], at[1] + r % 4 * (side / 4), at[2] + r / 4 * (side / 4)};
    sum_between(s, level - 1, a, b, below);
  }
}

static void sum_brick(sums *s, uint64_t bits, const int64_t at[3]) {
  uint64_t steps = (bits ^ bits << 1) & UINT64_C(0xeeeeeeeeeeeeeeee);
  int64_t left = s->sparse->space.dims[0] - at[0];
  if (left < 4) /* the step behind the last voxel is none */
    steps &= UINT64_C(0x1111111111111111) * vxm_low_bits((unsigned)left);
  add_steps(s, steps, at);
  s->sum.count += vxm_popcount(bits);
}

static void sum_within(sums *s, int level, cell node, const int64_t at[3]) {
  int64_t side = vxm_octree_side(level);
  for (unsigned r = 0; r < 16; r++) {
    int64_t z = at[2] + r / 4 * side;
    if (z >= s->end || z + side <= s->begin)
      continue;
    cell left = {EMPTY, 0};
    for (unsigned x = 0; x < 4; x++) {
      cell child = child_of(s->sparse, level, node, vxm_octree_child(x, r % 4, r / 4));
      const int64_t below[3] = {at[0] + x * side, at[1] + r % 4 * side, z};
      if (x > 0)
        sum_between(s, level, left, child, below);
      if (child.kind == MIXED && level > 0)
        sum_within(s, level - 1, child, below);
      else if (child.kind == MIXED)
        sum_brick(s, s->sparse->bricks[child.index], below);
      else if (child.kind == FULL)
        s->sum.count += side * side * (vxm_min(z + side, s->end) - vxm_max(z, s->begin));
      left = child;
    }
  }
}

typedef struct sum_job {
  const vxm_sparse *sparse;
  size_t tasks;
  vxm_sum parts[STEPS];
} sum_job;

static void sum_share(size_t task, int worker, void *payload) {
  (void)worker;
  sum_job *job = payload;
  const vxm_sparse *sparse = job->sparse;
  size_t shares = ((size_t)sparse->space.dims[2] + SHARE - 1) / SHARE;
  sums s = {.sparse = sparse,
            .begin = (int64_t)vxm_slice_begin(shares, job->tasks, task) * SHARE,
            .end = (int64_t)vxm_slice_begin(shares, job->tasks, task + 1) * SHARE};
  const int64_t origin[3] = {0, 0, 0};
  int top = sparse->levels - 1;
  const vxm_octree_node *root = &sparse->nodes[top][0];
  /* What lies before the grid is empty; a root all full is a cell of its own kind. */
  cell node = {root->full == ~UINT64_C(0) ? FULL : MIXED, 0};
  sum_between(&s, top + 1, (cell){EMPTY, 0}, node, origin);
  sum_within(&s, top, (cell){MIXED, 0}, origin);
  job->parts[task] = s.sum;
}

void vxm_octree_sum(const vxm_sparse *sparse, int64_t *count, uint64_t *hash) {
  sum_job job = {.sparse = sparse};
  size_t shares = ((size_t)sparse->space.dims[2] + SHARE - 1) / SHARE;
  job.tasks = shares < STEPS ? shares : STEPS;
  vxm_parallel(sparse->context, job.tasks, sum_share, &job);
  vxm_sum sum = vxm_sum_start(&sparse->space);
  for (size_t t = 0; t < job.tasks; t++)
    vxm_sum_join(&sum, job.parts[t]);
  *count = sum.count;
  *hash = sum.hash;
}
