/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/surface_tree.h"
#include "mesh/spatial_sort.h"
#include "voxel/closest/closest_point.h"

#include <math.h>
#include <string.h>

enum { LEAF = VXM_ORDER_LEAF, DEPTH_MAX = 40 };

typedef struct box {
  double low[3], high[3];
} box;

/** Triangles in spatial order; a leaf is a run of LEAF of them. Node n has the children 2 n and 2 n + 1, and
 * the leaves are the nodes from leaf_count on, which is a power of 2. */
struct vxm_surface_tree {
  vxm_context *context;
  size_t count, leaf_count;
  vxm_closest_triangle *triangles;
  uint32_t *numbers; /**< of the triangles, as their owner has them */
  box *boxes;
};

/** A box may be nearer than it is computed by as much. */
static const double box_slack = 1 - 1e-12;

static size_t leaves_for(size_t count) {
  size_t leaves = 1;
  while (leaves * LEAF < count)
    leaves *= 2;
  return leaves;
}

uint64_t vxm_surface_tree_bytes(size_t count) {
  return (uint64_t)count * (sizeof(vxm_closest_triangle) + sizeof(uint32_t) + sizeof(vxm_spatial_point)) +
         2 * (uint64_t)leaves_for(count) * sizeof(box) + 4096;
}

/* ---- Making it ---- */

static void make_leaf(vxm_surface_tree *tree, size_t leaf) {
  box *b = &tree->boxes[tree->leaf_count + leaf];
  for (int a = 0; a < 3; a++) {
    b->low[a] = INFINITY;
    b->high[a] = -INFINITY;
  }
  for (size_t i = leaf * LEAF; i < (leaf + 1) * LEAF && i < tree->count; i++)
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++) {
        b->low[a] = fmin(b->low[a], tree->triangles[i].at[c][a]);
        b->high[a] = fmax(b->high[a], tree->triangles[i].at[c][a]);
      }
}

static void make_boxes(vxm_surface_tree *tree) {
  for (size_t leaf = 0; leaf < tree->leaf_count; leaf++)
    make_leaf(tree, leaf);
  for (size_t n = tree->leaf_count - 1; n > 0; n--)
    for (int a = 0; a < 3; a++) {
      tree->boxes[n].low[a] = fmin(tree->boxes[2 * n].low[a], tree->boxes[2 * n + 1].low[a]);
      tree->boxes[n].high[a] = fmax(tree->boxes[2 * n].high[a], tree->boxes[2 * n + 1].high[a]);
    }
}

static vxm_status fill(vxm_surface_tree *tree, vxm_spatial_point *spots, vxm_surface_corners_fn corners,
                       const void *payload, vxm_error *error) {
  double at[3][3];
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < tree->count && status == VXM_OK; i++) {
    corners(at, i, payload);
    spots[i].index = (uint32_t)i;
    for (int a = 0; a < 3; a++)
      spots[i].at[a] = (float)(at[0][a] + at[1][a] + at[2][a]);
    status = vxm_ask_at(i, tree->context, error);
  }
  if (status == VXM_OK)
    status = vxm_spatial_sort(spots, tree->count, tree->context, error);
  for (size_t i = 0; i < tree->count && status == VXM_OK; i++) {
    corners(at, spots[i].index, payload);
    vxm_closest_triangle_make(&tree->triangles[i], (const double(*)[3])at);
    tree->numbers[i] = spots[i].index;
    status = vxm_ask_at(i, tree->context, error);
  }
  if (status == VXM_OK)
    make_boxes(tree);
  return status;
}

vxm_status vxm_surface_tree_create(vxm_surface_tree **out, vxm_context *context, size_t count,
                                   vxm_surface_corners_fn corners, const void *payload, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_spatial_point *spots = NULL;
  vxm_surface_tree *tree = vxm_calloc(context, 1, sizeof *tree, &local);
  *out = NULL;
  if (tree) {
    tree->context = context;
    tree->count = count;
    tree->leaf_count = leaves_for(count);
    tree->triangles = vxm_alloc(context, count, sizeof *tree->triangles, &local);
    tree->numbers = vxm_alloc(context, count, sizeof *tree->numbers, &local);
    tree->boxes = vxm_alloc(context, 2 * tree->leaf_count, sizeof *tree->boxes, &local);
    spots = vxm_alloc(context, count, sizeof *spots, &local);
  }
  if (local.code == VXM_OK)
    fill(tree, spots, corners, payload, &local);
  vxm_free(context, spots);
  if (local.code == VXM_OK)
    *out = tree;
  else {
    vxm_surface_tree_destroy(tree);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_surface_tree_destroy(vxm_surface_tree *tree) {
  if (!tree)
    return;
  vxm_free(tree->context, tree->boxes);
  vxm_free(tree->context, tree->numbers);
  vxm_free(tree->context, tree->triangles);
  vxm_free(tree->context, tree);
}

/* ---- Searching ---- */

typedef struct search {
  const vxm_surface_tree *tree;
  const double *p;
  double square;
  vxm_surface_hit hit;
} search;

static double to_box(const box *b, const double p[3]) {
  double square = 0;
  for (int a = 0; a < 3; a++) {
    double below = b->low[a] - p[a], above = p[a] - b->high[a];
    double off = below > above ? below : above;
    off = off > 0 ? off : 0;
    square += off * off;
  }
  return square * box_slack;
}

static void look_at(search *s, uint32_t place) {
  double foot[3], square = vxm_closest_point(&s->tree->triangles[place], s->p, foot);
  uint32_t number = s->tree->numbers[place];
  if (square > s->square || (square == s->square && number >= s->hit.triangle))
    return;
  s->square = square;
  s->hit = (vxm_surface_hit){.triangle = number, .place = place};
  memcpy(s->hit.foot, foot, sizeof foot);
}

static void look_at_leaf(search *s, size_t leaf) {
  for (size_t i = leaf * LEAF; i < (leaf + 1) * LEAF && i < s->tree->count; i++)
    look_at(s, (uint32_t)i);
}

vxm_surface_hit vxm_surface_tree_nearest(const vxm_surface_tree *tree, const double p[3], uint32_t near) {
  struct {
    size_t node;
    double square;
  } stack[DEPTH_MAX];
  search s = {.tree = tree, .p = p, .square = INFINITY, .hit = {.triangle = UINT32_MAX}};
  int depth = 0;
  look_at(&s, near < tree->count ? near : 0);
  stack[depth].node = 1;
  stack[depth++].square = to_box(&tree->boxes[1], p);
  while (depth > 0) {
    size_t node = stack[--depth].node;
    if (stack[depth].square > s.square)
      continue;
    if (node >= tree->leaf_count) {
      look_at_leaf(&s, node - tree->leaf_count);
      continue;
    }
    double left = to_box(&tree->boxes[2 * node], p), right = to_box(&tree->boxes[2 * node + 1], p);
    bool is_left_first = left <= right;
    /* The farther one waits below the nearer one. */
    stack[depth].node = 2 * node + is_left_first;
    stack[depth++].square = is_left_first ? right : left;
    stack[depth].node = 2 * node + !is_left_first;
    stack[depth++].square = is_left_first ? left : right;
  }
  return s.hit;
}
