/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/forest_tree.h"

#include <math.h>

typedef vxm_forest_node node;

/** More than the levels of a tree over 2^16 labels and one over 2^32 triangles. */
enum { STACK = 64 };

/** Added to squared distances before they become floats. */
static const double nearness_floor = 0x1p-20;
/** A box may be nearer than it is computed by as much. */
static const double box_slack = 1 - 1e-12;

void vxm_forest_destroy(vxm_forest *forest) {
  if (!forest)
    return;
  vxm_free(forest->context, forest->root);
  vxm_free(forest->context, forest->nodes);
  vxm_free(forest->context, forest->triangles);
  vxm_free(forest->context, forest);
}

static float nearness_of(double square) {
  return (float)(square + nearness_floor);
}

double vxm_forest_distance(float nearness) {
  return sqrt(fmax((double)nearness - nearness_floor, 0));
}

static float to_box(const node *n, const double p[3]) {
  double sum = 0;
  for (int a = 0; a < 3; a++) {
    double below = n->low[a] - p[a], above = p[a] - n->high[a];
    double off = below > above ? below : above;
    off = off > 0 ? off : 0;
    sum += off * off;
  }
  return nearness_of(sum * box_slack);
}

/** What is asked of a tree. */
typedef struct query {
  const vxm_forest *forest;
  const double *p;
  vxm_near best;    /**< what is to be bettered */
  uint32_t without; /**< a label that does not count; 0 = all do */
  bool first;       /**< the first that is found will do */
} query;

/** Whether something of this nearness in a node could be better; a node of several labels may have any. */
static bool betters(const query *q, float nearness, uint32_t label) {
  return nearness < q->best.nearness || (nearness == q->best.nearness && label < q->best.label);
}

static bool is_worthwhile(const query *q, const node *n, float nearness) {
  return betters(q, nearness, n->label) && (q->without == 0 || n->label != q->without);
}

static void search_leaf(query *q, const node *leaf) {
  for (uint32_t i = leaf->begin; i < leaf->end; i++) {
    float nearness = nearness_of(vxm_triangle_distance2(&q->forest->triangles[i], q->p));
    if (betters(q, nearness, leaf->label))
      q->best = (vxm_near){nearness, leaf->label, i};
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
    if (is_worthwhile(q, at, nearness) && at->left) { /* the nearer child first */
      const node *child = &q->forest->nodes[at->left], *other = child + 1;
      float to_child = to_box(child, q->p), to_other = to_box(other, q->p);
      bool is_child = to_child <= to_other;
      stack[depth].node = is_child ? other : child;
      stack[depth++].nearness = is_child ? to_other : to_child;
      at = is_child ? child : other;
      nearness = is_child ? to_child : to_other;
      continue;
    }
    if (is_worthwhile(q, at, nearness))
      search_leaf(q, at);
    if (depth == 0 || (q->first && q->best.label != UINT32_MAX))
      return;
    at = stack[--depth].node;
    nearness = stack[depth].nearness;
  }
}

vxm_near vxm_forest_nearest(const vxm_forest *forest, const double p[3], const vxm_near *from) {
  query q = {.forest = forest, .p = p, .best = {INFINITY, 0, 0}};
  if (from && from->label)
    q.best = (vxm_near){nearness_of(vxm_triangle_distance2(&forest->triangles[from->triangle], p)),
                        from->label, from->triangle};
  search(&q, forest->nodes);
  return q.best;
}

float vxm_forest_nearness(const vxm_forest *forest, const double p[3], uint32_t label) {
  query q = {.forest = forest, .p = p, .best = {INFINITY, 0, 0}};
  if (forest->root[label - 1] != VXM_NO_ROOT)
    search(&q, &forest->nodes[forest->root[label - 1]]);
  return q.best.nearness;
}

bool vxm_forest_has_other(const vxm_forest *forest, const double p[3], uint32_t label, double reach) {
  query q = {.forest = forest,
             .p = p,
             .best = {nearness_of(reach * reach), UINT32_MAX, 0},
             .without = label,
             .first = true};
  search(&q, forest->nodes);
  return q.best.label != UINT32_MAX;
}
