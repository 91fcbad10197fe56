/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/label_bvh_tree.h"

#include <math.h>

typedef vxm_label_bvh_node node;

/** More than the levels of a tree over 2^16 labels and one over 2^32 triangles. */
enum { STACK = 64 };

/** Added to squared distances before they become floats. */
static const double nearness_floor = 0x1p-20;
/** A box may be nearer than it is computed by as much. */
static const double box_slack = 1 - 1e-12;
/** More than what rounds in distances and gradients, in voxels and of the distance. */
static const double slack = 1e-3, relative_slack = 1e-6;

void vxm_label_bvh_destroy(vxm_label_bvh *bvh) {
  if (!bvh)
    return;
  vxm_free(bvh->context, bvh->root);
  vxm_free(bvh->context, bvh->nodes);
  vxm_free(bvh->context, bvh->triangles);
  vxm_free(bvh->context, bvh);
}

static float nearness_of(double square) {
  return (float)(square + nearness_floor);
}

float vxm_nearness_at(double distance) {
  return nearness_of(distance * distance);
}

/* ---- Triangles and boxes from a point ---- */

/** What is seen of a foot; without a gradient where that is too near to have one. */
static vxm_label_hit seen(const double p[3], const double foot[3], double square) {
  vxm_label_hit near = {.nearness = nearness_of(square), .distance = sqrtf((float)square)};
  float inverse = near.distance > (float)slack ? 1 / near.distance : 0;
  for (int a = 0; a < 3; a++)
    near.gradient[a] = (float)(p[a] - foot[a]) * inverse;
  return near;
}

float vxm_label_bvh_nearness(const vxm_label_bvh *bvh, uint32_t triangle, const double p[3]) {
  double foot[3];
  return nearness_of(vxm_closest_point(&bvh->triangles[triangle], p, foot));
}

vxm_label_hit vxm_label_bvh_view(const vxm_label_bvh *bvh, uint32_t label, uint32_t triangle,
                                 const double p[3]) {
  double foot[3], square = vxm_closest_point(&bvh->triangles[triangle], p, foot);
  vxm_label_hit near = seen(p, foot, square);
  near.label = label;
  near.triangle = triangle;
  return near;
}

static vxm_label_hit view_box(const node *n, const double p[3]) {
  double foot[3], square = 0;
  for (int a = 0; a < 3; a++) {
    foot[a] = p[a] < n->low[a] ? n->low[a] : p[a] > n->high[a] ? n->high[a] : p[a];
    square += (p[a] - foot[a]) * (p[a] - foot[a]);
  }
  return seen(p, foot, square);
}

static float to_box(const node *n, const double p[3]) {
  double square = 0;
  for (int a = 0; a < 3; a++) {
    double below = n->low[a] - p[a], above = p[a] - n->high[a];
    double off = below > above ? below : above;
    off = off > 0 ? off : 0;
    square += off * off;
  }
  return nearness_of(square * box_slack);
}

/**
 * With u from the middle to a point of the block, distance D and gradient G of the nearest, d and g of the
 * other: the distance of what is convex is convex, so the other has at least d + g.u; the foot of the nearest
 * is at most D + G.u + u.u / 2D away, and at most D + |u|.
 */
bool vxm_bvh_block_excludes(const vxm_bvh_block *block, const vxm_label_hit *nearest,
                            const vxm_label_hit *other) {
  double to_nearest = (double)nearest->distance, to_other = (double)other->distance,
         ahead = to_other * (1 - relative_slack) - slack - to_nearest, turn = 0;
  if (ahead > 2 * block->reach)
    return true;
  if (to_nearest <= slack)
    return false;
  for (int a = 0; a < 3; a++)
    turn += fabs((double)other->gradient[a] - (double)nearest->gradient[a]) * block->half[a];
  return ahead > turn + block->reach * block->reach / (2 * to_nearest);
}

/* ---- The nearest ---- */

/** What is asked of a tree. */
typedef struct query {
  const vxm_label_bvh *bvh;
  const double *p;
  float nearness; /**< what is to be bettered */
  uint32_t label, triangle;
  uint32_t preferred; /**< as in vxm_label_filter */
} query;

/** Of equally near labels the one with the lowest rank is taken; nodes of several may have any. */
static uint32_t rank_of(const query *q, uint32_t label) {
  return label == q->preferred ? 0 : label;
}

/** Whether something of this nearness in a node could be better. */
static bool betters(const query *q, float nearness, uint32_t label) {
  return nearness < q->nearness || (nearness == q->nearness && rank_of(q, label) < rank_of(q, q->label));
}

static void search_leaf(query *q, const node *leaf) {
  for (uint32_t i = leaf->begin; i < leaf->end; i++) {
    float nearness = vxm_label_bvh_nearness(q->bvh, i, q->p);
    if (betters(q, nearness, leaf->label)) {
      q->nearness = nearness;
      q->label = leaf->label;
      q->triangle = i;
    }
  }
}

static void search(query *q, const node *at) {
  struct {
    const node *node;
    float nearness;
  } stack[STACK];
  int depth = 0;
  float nearness = to_box(at, q->p);
  for (;;) {
    if (betters(q, nearness, at->label) && at->left) { /* the nearer child first */
      const node *child = &q->bvh->nodes[at->left], *other = child + 1;
      float to_child = to_box(child, q->p), to_other = to_box(other, q->p);
      bool is_child = to_child <= to_other;
      stack[depth].node = is_child ? other : child;
      stack[depth++].nearness = is_child ? to_other : to_child;
      at = is_child ? child : other;
      nearness = is_child ? to_child : to_other;
      continue;
    }
    if (betters(q, nearness, at->label))
      search_leaf(q, at);
    if (depth == 0)
      return;
    at = stack[--depth].node;
    nearness = stack[depth].nearness;
  }
}

/** The roots of what is asked about; returns how many. */
static int roots_of(const node *out[2], const vxm_label_bvh *bvh, vxm_label_filter filter) {
  int count = 0;
  if (filter.label[0] == 0) {
    out[0] = bvh->nodes;
    return 1;
  }
  for (int i = 0; i < 2; i++) {
    uint32_t root = bvh->root[filter.label[i] - 1];
    if (root != VXM_NO_ROOT)
      out[count++] = &bvh->nodes[root];
  }
  return count;
}

vxm_label_hit vxm_label_bvh_nearest(const vxm_label_bvh *bvh, vxm_label_filter filter, const double p[3],
                                    const vxm_label_hit *from) {
  query q = {.bvh = bvh, .p = p, .nearness = from->nearness, .preferred = filter.preferred};
  if (from->label) {
    q.nearness = vxm_label_bvh_nearness(bvh, from->triangle, p);
    q.label = from->label;
    q.triangle = from->triangle;
  }
  const node *roots[2];
  int count = roots_of(roots, bvh, filter);
  for (int i = 0; i < count; i++)
    search(&q, roots[i]);
  return q.label ? vxm_label_bvh_view(bvh, q.label, q.triangle, p) : (vxm_label_hit){.nearness = INFINITY};
}

/* ---- What may be the nearest somewhere in a block ---- */

/** Lists as vxm_label_bvh_list does, below a root and without the nodes of a label (0 = with all). */
static size_t list_below(const node *at, const vxm_label_bvh *bvh, uint32_t without,
                         const vxm_bvh_block *block, const vxm_label_hit *nearest, vxm_label_hit *out,
                         size_t capacity) {
  const node *stack[STACK];
  size_t count = 0;
  int depth = 0;
  for (;;) {
    vxm_label_hit box = view_box(at, block->middle);
    bool is_met = (without == 0 || at->label != without) && !vxm_bvh_block_excludes(block, nearest, &box);
    if (is_met && at->left) {
      at = &bvh->nodes[at->left];
      stack[depth++] = at + 1;
      continue;
    }
    for (uint32_t i = at->begin; i < at->end && is_met; i++) {
      vxm_label_hit near = vxm_label_bvh_view(bvh, at->label, i, block->middle);
      if (vxm_bvh_block_excludes(block, nearest, &near))
        continue;
      if (count == capacity)
        return capacity + 1;
      out[count++] = near;
    }
    if (depth == 0)
      return count;
    at = stack[--depth];
  }
}

size_t vxm_label_bvh_list(const vxm_label_bvh *bvh, vxm_label_filter filter, const vxm_bvh_block *block,
                          const vxm_label_hit *nearest, vxm_label_hit *out, size_t capacity) {
  const node *roots[2];
  int root_count = roots_of(roots, bvh, filter);
  size_t count = 0;
  for (int i = 0; i < root_count && count <= capacity; i++)
    count += list_below(roots[i], bvh, 0, block, nearest, out + count, capacity - count);
  return count;
}

bool vxm_label_bvh_has_other(const vxm_label_bvh *bvh, vxm_label_filter filter, const vxm_bvh_block *block,
                             const vxm_label_hit *nearest) {
  const node *roots[2];
  int root_count = roots_of(roots, bvh, filter);
  bool has_other = false;
  for (int i = 0; i < root_count && !has_other; i++)
    has_other = list_below(roots[i], bvh, nearest->label, block, nearest, NULL, 0) > 0;
  return has_other;
}
