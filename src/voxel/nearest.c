/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/nearest.h"
#include "voxel/triangle.h"

#include <string.h>

enum { LEAF = 4, STACK = 64 };

/** A box over triangles begin..end-1. The children of a node that is no leaf are `left` and the next. */
typedef struct node {
  double low[3], high[3];
  uint32_t begin, end;
  uint32_t left; /**< 0 = a leaf */
} node;

struct vxm_nearest {
  vxm_context *context;
  double (*corners)[3][3]; /**< in the order of the leaves; only while the tree is built */
  vxm_triangle *triangles; /**< the same, made ready: that costs as much as several distances */
  node *nodes;
  size_t node_count;
};

/** Leaves have at least (LEAF + 1) / 2 triangles, unless there is one leaf. */
static size_t nodes_max(size_t count) {
  return 1 + 2 * (count / ((LEAF + 1) / 2));
}

uint64_t vxm_nearest_bytes(size_t count) {
  return count * (sizeof(double[3][3]) + sizeof(vxm_triangle)) + nodes_max(count) * sizeof(node) +
         sizeof(vxm_nearest) + 256;
}

/* ---- Building ---- */

static void bound(node *n, double (*corners)[3][3]) {
  memcpy(n->low, corners[n->begin][0], sizeof n->low);
  memcpy(n->high, corners[n->begin][0], sizeof n->high);
  for (size_t i = n->begin; i < n->end; i++)
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++) {
        double x = corners[i][c][a];
        n->low[a] = x < n->low[a] ? x : n->low[a];
        n->high[a] = x > n->high[a] ? x : n->high[a];
      }
}

static double middle(double (*triangle)[3], int axis) {
  return triangle[0][axis] + triangle[1][axis] + triangle[2][axis];
}

static void swap(double (*a)[3], double (*b)[3]) {
  double kept[3][3];
  memcpy(kept, a, sizeof kept);
  memmove(a, b, sizeof kept);
  memcpy(b, kept, sizeof kept);
}

/** Cuts begin..end-1, two or more, in two (Hoare): all before the cut are at most those behind, and neither
 * is empty. */
static size_t cut(double (*corners)[3][3], size_t begin, size_t end, int axis) {
  double pivot = middle(corners[begin + (end - begin - 1) / 2], axis);
  for (size_t i = begin, j = end - 1;; i++, j--) {
    while (middle(corners[i], axis) < pivot)
      i++;
    while (middle(corners[j], axis) > pivot)
      j--;
    if (i >= j)
      return j + 1;
    swap(corners[i], corners[j]);
  }
}

/** Moves the triangles with the lesser middles before place `half`. */
static void halve(double (*corners)[3][3], size_t begin, size_t end, size_t half, int axis) {
  while (end - begin > 1) {
    size_t at = cut(corners, begin, end, axis);
    if (half < at)
      end = at;
    else
      begin = at;
  }
}

static void build(vxm_nearest *tree, size_t count) {
  tree->nodes[0] = (node){.begin = 0, .end = (uint32_t)count};
  tree->node_count = 1;
  for (size_t n = 0; n < tree->node_count; n++) {
    node *at = &tree->nodes[n];
    bound(at, tree->corners);
    if (at->end - at->begin <= LEAF)
      continue;
    int axis = 0;
    for (int a = 1; a < 3; a++)
      axis = at->high[a] - at->low[a] > at->high[axis] - at->low[axis] ? a : axis;
    uint32_t half = at->begin + (at->end - at->begin) / 2;
    halve(tree->corners, at->begin, at->end, half, axis);
    at->left = (uint32_t)tree->node_count;
    tree->nodes[tree->node_count++] = (node){.begin = at->begin, .end = half};
    tree->nodes[tree->node_count++] = (node){.begin = half, .end = at->end};
  }
}

vxm_status vxm_nearest_create(vxm_nearest **out, vxm_context *context, double (*corners)[3][3], size_t count,
                              vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_nearest *tree = vxm_calloc(context, 1, sizeof *tree, &local);
  *out = NULL;
  if (tree) {
    tree->context = context;
    tree->corners = corners;
    tree->triangles = vxm_alloc(context, count, sizeof *tree->triangles, &local);
    tree->nodes = vxm_alloc(context, nodes_max(count), sizeof *tree->nodes, &local);
  } else
    vxm_free(context, corners);
  if (tree && tree->nodes && tree->triangles) {
    build(tree, count);
    for (size_t i = 0; i < count; i++)
      vxm_triangle_make(&tree->triangles[i], (const double(*)[3])corners[i]);
    vxm_free(context, tree->corners);
    tree->corners = NULL;
    *out = tree;
    return VXM_OK;
  }
  vxm_nearest_destroy(tree);
  if (error)
    *error = local;
  return local.code;
}

void vxm_nearest_destroy(vxm_nearest *nearest) {
  if (!nearest)
    return;
  vxm_free(nearest->context, nearest->triangles);
  vxm_free(nearest->context, nearest->nodes);
  vxm_free(nearest->context, nearest->corners);
  vxm_free(nearest->context, nearest);
}

/* ---- Asking ---- */

static double to_box2(const node *n, const double p[3]) {
  double sum = 0;
  for (int a = 0; a < 3; a++) {
    double below = n->low[a] - p[a], above = p[a] - n->high[a];
    double off = below > above ? below : above;
    off = off > 0 ? off : 0;
    sum += off * off;
  }
  return sum;
}

static double to_triangle2(const vxm_nearest *tree, size_t triangle, const double p[3]) {
  return vxm_triangle_distance2(&tree->triangles[triangle], p);
}

static double search_leaf(const vxm_nearest *tree, const node *leaf, const double p[3], double least,
                          size_t *triangle) {
  for (size_t i = leaf->begin; i < leaf->end; i++) {
    double square = to_triangle2(tree, i, p);
    if (square < least) {
      least = square;
      *triangle = i;
    }
  }
  return least;
}

double vxm_nearest_distance2(const vxm_nearest *nearest, const double p[3], double least, size_t *triangle) {
  struct {
    const node *node;
    double square;
  } stack[STACK];
  int depth = 0;
  const node *at = nearest->nodes;
  double square = to_triangle2(nearest, *triangle, p);
  least = square < least ? square : least;
  square = to_box2(at, p);
  for (;;) {
    if (square < least && at->left) { /* the nearer child first */
      const node *child = &nearest->nodes[at->left], *other = child + 1;
      double to_child = to_box2(child, p), to_other = to_box2(other, p);
      bool is_child = to_child <= to_other;
      stack[depth].node = is_child ? other : child;
      stack[depth++].square = is_child ? to_other : to_child;
      at = is_child ? child : other;
      square = is_child ? to_child : to_other;
      continue;
    }
    if (square < least)
      least = search_leaf(nearest, at, p, least, triangle);
    if (depth == 0)
      return least;
    at = stack[--depth].node;
    square = stack[depth].square;
  }
}
