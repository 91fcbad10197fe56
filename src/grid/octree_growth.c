/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_growth.h"
#include "base/threads.h"

#include <string.h>

void vxm_octree_growth_begin(vxm_octree_growth *out, vxm_context *context, const vxm_space *space,
                             vxm_error *error) {
  *out = (vxm_octree_growth){.error = error};
  out->status = vxm_octree_new(&out->sparse, context, space, error);
}

void vxm_octree_growth_reserve(vxm_octree_growth *growth, const vxm_sparse *a, const vxm_sparse *b) {
  vxm_sparse *sparse = growth->sparse;
  if (growth->status == VXM_OK)
    growth->status = vxm_grow(sparse->context, (void **)&sparse->bricks, &growth->brick_capacity,
                              a->brick_count + b->brick_count, sizeof *sparse->bricks, growth->error);
  for (int l = 0; growth->status == VXM_OK && l < sparse->levels; l++)
    growth->status = vxm_grow(sparse->context, (void **)&sparse->nodes[l], &growth->node_capacity[l],
                              a->node_count[l] + b->node_count[l], sizeof *sparse->nodes[l], growth->error);
}

vxm_octree_state vxm_octree_growth_brick(vxm_octree_growth *growth, uint64_t bits) {
  if (bits == 0 || bits == ~UINT64_C(0) || growth->status != VXM_OK)
    return bits ? VXM_OCTREE_FULL : VXM_OCTREE_EMPTY;
  vxm_sparse *sparse = growth->sparse;
  growth->status = vxm_grow(sparse->context, (void **)&sparse->bricks, &growth->brick_capacity,
                            sparse->brick_count + 1, sizeof *sparse->bricks, growth->error);
  if (growth->status == VXM_OK)
    sparse->bricks[sparse->brick_count++] = bits;
  return VXM_OCTREE_MIXED;
}

vxm_octree_state vxm_octree_growth_node(vxm_octree_growth *growth, int level, uint64_t mixed, uint64_t full,
                                        size_t first) {
  if (growth->status != VXM_OK)
    return VXM_OCTREE_EMPTY;
  vxm_sparse *sparse = growth->sparse;
  if (level < sparse->levels - 1 && mixed == 0 && (full == 0 || full == ~UINT64_C(0)))
    return full ? VXM_OCTREE_FULL : VXM_OCTREE_EMPTY;
  size_t *count = &sparse->node_count[level];
  growth->status = vxm_grow(sparse->context, (void **)&sparse->nodes[level], &growth->node_capacity[level],
                            *count + 1, sizeof *sparse->nodes[level], growth->error);
  if (growth->status == VXM_OK)
    sparse->nodes[level][(*count)++] = (vxm_octree_node){mixed, full, mixed ? first : 0};
  return VXM_OCTREE_MIXED;
}

/* ---- Parts of other octrees ---- */

/** Runs of so many are left for the end; shorter ones would take more room than they save time. */
enum { LONG_RUN = 512, SHARES = 64 };

/** Copies what goes to begin..end-1 of the bricks, for level -1, or of the nodes of a level. */
static void copy_run(vxm_sparse *to, int level, const vxm_octree_run *run, size_t begin, size_t end) {
  size_t from = run->begin + (begin - run->to);
  if (level < 0) {
    memcpy(to->bricks + begin, run->from->bricks + from, (end - begin) * sizeof *to->bricks);
    return;
  }
  for (size_t n = begin; n < end; n++, from++) {
    vxm_octree_node node = run->from->nodes[level][from];
    node.first += node.mixed ? run->shift : 0;
    to->nodes[level][n] = node;
  }
}

typedef struct copy_job {
  vxm_sparse *to;
  int level;
  const vxm_octree_runs *runs;
  size_t count, shares; /**< of the level */
} copy_job;

static void copy_share(size_t task, int worker, void *payload) {
  (void)worker;
  const copy_job *job = payload;
  const vxm_octree_run *list = job->runs->list;
  size_t begin = vxm_slice_begin(job->count, job->shares, task);
  size_t end = vxm_slice_begin(job->count, job->shares, task + 1), first = 0;
  for (size_t behind = job->runs->count; first < behind;) { /* the first that reaches beyond `begin` */
    size_t middle = first + (behind - first) / 2;
    if (list[middle].to + list[middle].count <= begin)
      first = middle + 1;
    else
      behind = middle;
  }
  for (; first < job->runs->count && list[first].to < end; first++) {
    size_t low = list[first].to, high = low + list[first].count;
    copy_run(job->to, job->level, &list[first], low < begin ? begin : low, high < end ? high : end);
  }
}

/** Copies all runs that were left for the end. */
static void copy_runs(vxm_octree_growth *growth) {
  vxm_sparse *sparse = growth->sparse;
  for (int l = -1; l < sparse->levels; l++) {
    copy_job job = {sparse, l, &growth->runs[1 + l], l < 0 ? sparse->brick_count : sparse->node_count[l], 0};
    job.shares = job.count / LONG_RUN < SHARES ? job.count / LONG_RUN + 1 : SHARES;
    if (job.runs->count > 0)
      vxm_parallel(sparse->context, job.shares, copy_share, &job);
  }
}

/** Adds a run, which has room. */
static void add_run(vxm_octree_growth *growth, int level, const vxm_octree_run *run) {
  vxm_octree_runs *runs = &growth->runs[1 + level];
  vxm_octree_run *last = runs->count > 0 ? &runs->list[runs->count - 1] : NULL;
  if (last && last->from == run->from && last->begin + last->count == run->begin &&
      last->to + last->count == run->to && last->shift == run->shift) {
    last->count += run->count;
    return;
  }
  if (last && last->count < LONG_RUN) {
    copy_run(growth->sparse, level, last, last->to, last->to + last->count);
    *last = *run;
    return;
  }
  growth->status = vxm_grow(growth->sparse->context, (void **)&runs->list, &runs->capacity, runs->count + 1,
                            sizeof *runs->list, growth->error);
  if (growth->status == VXM_OK)
    runs->list[runs->count++] = *run;
}

/** Nodes or bricks side by side. */
typedef struct range {
  size_t begin, end;
} range;

/** The mixed children of nodes. */
static range children_of(const vxm_octree_node *nodes, range of) {
  while (of.begin < of.end && nodes[of.begin].mixed == 0)
    of.begin++;
  while (of.begin < of.end && nodes[of.end - 1].mixed == 0)
    of.end--;
  if (of.begin == of.end)
    return (range){0, 0};
  const vxm_octree_node *last = &nodes[of.end - 1];
  return (range){(size_t)nodes[of.begin].first, (size_t)last->first + (size_t)vxm_popcount(last->mixed)};
}

vxm_octree_state vxm_octree_growth_copy(vxm_octree_growth *growth, const vxm_sparse *from, int level,
                                        size_t node) {
  vxm_sparse *sparse = growth->sparse;
  range here = {node, node + 1};
  for (; level >= 0 && here.begin < here.end && growth->status == VXM_OK; level--) {
    size_t *count = &sparse->node_count[level], more = here.end - here.begin;
    range below = children_of(from->nodes[level], here);
    uint64_t shift = vxm_octree_growth_next(growth, level) - below.begin;
    growth->status = vxm_grow(sparse->context, (void **)&sparse->nodes[level], &growth->node_capacity[level],
                              *count + more, sizeof *sparse->nodes[level], growth->error);
    if (growth->status == VXM_OK)
      add_run(growth, level, &(vxm_octree_run){from, here.begin, more, *count, shift});
    *count += growth->status == VXM_OK ? more : 0;
    here = below;
  }
  size_t bricks = here.end - here.begin;
  if (growth->status == VXM_OK)
    growth->status = vxm_grow(sparse->context, (void **)&sparse->bricks, &growth->brick_capacity,
                              sparse->brick_count + bricks, sizeof *sparse->bricks, growth->error);
  if (growth->status == VXM_OK && bricks > 0)
    add_run(growth, -1, &(vxm_octree_run){from, here.begin, bricks, sparse->brick_count, 0});
  sparse->brick_count += growth->status == VXM_OK ? bricks : 0;
  return growth->status == VXM_OK ? VXM_OCTREE_MIXED : VXM_OCTREE_EMPTY;
}

vxm_status vxm_octree_growth_end(vxm_sparse **out, vxm_octree_growth *growth) {
  *out = NULL;
  if (growth->status == VXM_OK)
    copy_runs(growth);
  for (int l = 0; l <= VXM_OCTREE_LEVELS && growth->sparse; l++)
    vxm_free(growth->sparse->context, growth->runs[l].list);
  if (growth->status == VXM_OK)
    *out = growth->sparse;
  else
    vxm_sparse_destroy(growth->sparse);
  growth->sparse = NULL;
  return growth->status;
}
