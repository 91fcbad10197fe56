/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_growth.h"

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

/** The mixed children of nodes side by side. */
typedef struct run {
  size_t begin, end;
} run;

static run children_of(const vxm_octree_node *nodes, run of) {
  while (of.begin < of.end && nodes[of.begin].mixed == 0)
    of.begin++;
  while (of.begin < of.end && nodes[of.end - 1].mixed == 0)
    of.end--;
  if (of.begin == of.end)
    return (run){0, 0};
  const vxm_octree_node *last = &nodes[of.end - 1];
  return (run){(size_t)nodes[of.begin].first, (size_t)last->first + (size_t)vxm_popcount(last->mixed)};
}

vxm_octree_state vxm_octree_growth_copy(vxm_octree_growth *growth, const vxm_sparse *from, int level,
                                        size_t node) {
  vxm_sparse *sparse = growth->sparse;
  run here = {node, node + 1};
  for (; level >= 0 && here.begin < here.end && growth->status == VXM_OK; level--) {
    size_t *count = &sparse->node_count[level], first = vxm_octree_growth_next(growth, level);
    run below = children_of(from->nodes[level], here);
    growth->status = vxm_grow(sparse->context, (void **)&sparse->nodes[level], &growth->node_capacity[level],
                              *count + here.end - here.begin, sizeof *sparse->nodes[level], growth->error);
    for (size_t n = here.begin; n < here.end && growth->status == VXM_OK; n++) {
      vxm_octree_node copy = from->nodes[level][n];
      copy.first = copy.mixed ? copy.first - below.begin + first : 0;
      sparse->nodes[level][(*count)++] = copy;
    }
    here = below;
  }
  size_t bricks = here.end - here.begin;
  if (growth->status == VXM_OK)
    growth->status = vxm_grow(sparse->context, (void **)&sparse->bricks, &growth->brick_capacity,
                              sparse->brick_count + bricks, sizeof *sparse->bricks, growth->error);
  if (growth->status == VXM_OK && bricks > 0)
    memcpy(sparse->bricks + sparse->brick_count, from->bricks + here.begin, bricks * sizeof *sparse->bricks);
  sparse->brick_count += growth->status == VXM_OK ? bricks : 0;
  return growth->status == VXM_OK ? VXM_OCTREE_MIXED : VXM_OCTREE_EMPTY;
}

vxm_status vxm_octree_growth_end(vxm_sparse **out, vxm_octree_growth *growth) {
  *out = NULL;
  if (growth->status == VXM_OK)
    *out = growth->sparse;
  else
    vxm_sparse_destroy(growth->sparse);
  growth->sparse = NULL;
  return growth->status;
}
