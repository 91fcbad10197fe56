/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/box.h"
#include "base/threads.h"
#include "mesh/triangulate.h"
#include "voxel/labels/label_bvh_tree.h"

#include <math.h>

typedef vxm_label_bvh_node node;

enum { LEAF = 4 };

/** What is sorted: a triangle, or the tree of a label, whose place in the list is its first corner. */
typedef struct item {
  uint32_t corner[3];
  float middle[3]; /**< times a number that is the same for all */
} item;

/** A BVH in the making. */
typedef struct builder {
  vxm_label_bvh *bvh;
  item *items;
  uint32_t *first; /**< of each label, its first triangle; one more for the end */
  /* Of the labels that have triangles: */
  uint32_t count;
  node *roots;
  uint32_t *room; /**< where the nodes below the root begin */
  item *boxes;
} builder;

/* ---- Triangles ---- */

static void place(const vxm_label_bvh *bvh, double out[3], uint32_t vertex) {
  const double *p = vxm_position(bvh->labelling->soup, vertex);
  for (int a = 0; a < 3; a++)
    out[a] = (p[a] - bvh->origin[a]) / bvh->side;
}

/** Whether all corners are finite. */
static bool make_item(const vxm_label_bvh *bvh, item *out, const uint32_t corner[3]) {
  double middle[3] = {0, 0, 0};
  for (int c = 0; c < 3; c++) {
    double p[3];
    place(bvh, p, corner[c]);
    for (int a = 0; a < 3; a++)
      middle[a] += p[a];
    out->corner[c] = corner[c];
  }
  for (int a = 0; a < 3; a++)
    out->middle[a] = (float)middle[a];
  return isfinite(middle[0]) && isfinite(middle[1]) && isfinite(middle[2]);
}

static size_t count_triangles(const vxm_face_labels *l) {
  size_t sum = 0;
  for (size_t i = 0; i < l->begin[l->table.count]; i++) {
    size_t n;
    vxm_face(l->soup, l->faces[i], &n);
    sum += n > 2 ? n - 2 : 0;
  }
  return sum;
}

/** Cuts the faces of all labels, in order. */
static vxm_status make_items(builder *b, vxm_error *error) {
  const vxm_face_labels *l = b->bvh->labelling;
  vxm_triangulator triangulator;
  vxm_status status = VXM_OK;
  uint32_t count = 0;
  vxm_triangulator_open(&triangulator, b->bvh->context);
  for (size_t label = 1; label <= l->table.count; label++) {
    b->first[label - 1] = count;
    for (size_t i = l->begin[label - 1]; i < l->begin[label] && status == VXM_OK; i++) {
      size_t n;
      const uint32_t *corner = vxm_face(l->soup, l->faces[i], &n), *cut = corner;
      if (n > 3)
        status = vxm_triangulate(&triangulator, l->soup->positions, corner, n, &cut, error);
      for (size_t t = 0; t + 2 < n && status == VXM_OK; t++)
        count += make_item(b->bvh, &b->items[count], cut + 3 * t);
    }
  }
  b->first[l->table.count] = count;
  vxm_triangulator_close(&triangulator);
  return status;
}

/* ---- Nodes ---- */

static void bound_triangles(const builder *b, node *n) {
  vxm_box_empty(n->low, n->high);
  for (uint32_t i = n->begin; i < n->end; i++)
    for (int c = 0; c < 3; c++) {
      double p[3];
      place(b->bvh, p, b->items[i].corner[c]);
      vxm_box_include(n->low, n->high, p);
    }
}

static int longest_axis(const node *n) {
  int axis = 0;
  for (int a = 1; a < 3; a++)
    axis = n->high[a] - n->low[a] > n->high[axis] - n->low[axis] ? a : axis;
  return axis;
}

/** Cuts items begin..end-1, two or more, in two (Hoare): all before the cut are at most those behind, and
 * neither is empty. */
static uint32_t cut_items(item *items, uint32_t begin, uint32_t end, int axis) {
  float pivot = items[begin + (end - begin - 1) / 2].middle[axis];
  for (uint32_t i = begin, j = end - 1;; i++, j--) {
    while (items[i].middle[axis] < pivot)
      i++;
    while (items[j].middle[axis] > pivot)
      j--;
    if (i >= j)
      return j + 1;
    item kept = items[i];
    items[i] = items[j];
    items[j] = kept;
  }
}

/** Moves the items with the lesser middles before place `half`. */
static void halve(item *items, uint32_t begin, uint32_t end, uint32_t half, int axis) {
  while (end - begin > 1) {
    uint32_t at = cut_items(items, begin, end, axis);
    if (half < at)
      end = at;
    else
      begin = at;
  }
}

/** Gives a node its children, in the next two places. */
static void split(const builder *b, node *at, item *items, uint32_t *next) {
  uint32_t half = at->begin + (at->end - at->begin) / 2;
  halve(items, at->begin, at->end, half, longest_axis(at));
  at->left = *next;
  b->bvh->nodes[(*next)++] = (node){.begin = at->begin, .end = half, .label = at->label};
  b->bvh->nodes[(*next)++] = (node){.begin = half, .end = at->end, .label = at->label};
}

/* ---- The tree of a label ---- */

/** Nodes below the root of so many triangles: leaves have at least (LEAF + 1) / 2 of them. */
static size_t nodes_below(size_t count) {
  return count > LEAF ? 2 * (count / ((LEAF + 1) / 2)) : 0;
}

static void grow_node(const builder *b, node *at, uint32_t *next) {
  if (at->end - at->begin <= LEAF)
    return;
  split(b, at, b->items, next);
  bound_triangles(b, &b->bvh->nodes[at->left]);
  bound_triangles(b, &b->bvh->nodes[at->left + 1]);
}

static void grow_tree(size_t task, int worker, void *payload) {
  (void)worker;
  const builder *b = payload;
  const vxm_label_bvh *bvh = b->bvh;
  uint32_t label = b->roots[task].label, next = b->room[task];
  grow_node(b, &bvh->nodes[bvh->root[label - 1]], &next);
  for (uint32_t n = b->room[task]; n < next; n++)
    grow_node(b, &bvh->nodes[n], &next);
  for (uint32_t t = b->first[label - 1]; t < b->first[label]; t++) {
    double corner[3][3];
    for (int c = 0; c < 3; c++)
      place(bvh, corner[c], b->items[t].corner[c]);
    vxm_closest_triangle_make(&bvh->triangles[t], (const double(*)[3])corner);
  }
}

/* ---- The tree over the trees ---- */

/** Makes the roots, and lists them. */
static void make_roots(builder *b) {
  size_t labels = b->bvh->labelling->table.count;
  for (uint32_t label = 1; label <= labels; label++) {
    node *root = &b->roots[b->count];
    item *box = &b->boxes[b->count];
    *root = (node){.begin = b->first[label - 1], .end = b->first[label], .label = label};
    b->bvh->root[label - 1] = VXM_NO_ROOT;
    if (root->begin == root->end)
      continue;
    bound_triangles(b, root);
    for (int a = 0; a < 3; a++)
      box->middle[a] = (float)(root->low[a] + root->high[a]);
    box->corner[0] = b->count++;
  }
}

/** Makes the nodes down to the roots; those below them get their rooms behind. */
static void grow_upper_tree(builder *b) {
  vxm_label_bvh *bvh = b->bvh;
  uint32_t next = 1;
  bvh->nodes[0] = (node){.end = b->count};
  for (uint32_t n = 0; n < next; n++) {
    node *at = &bvh->nodes[n];
    if (at->end - at->begin == 1) {
      *at = b->roots[b->boxes[at->begin].corner[0]];
      bvh->root[at->label - 1] = n;
      continue;
    }
    vxm_box_empty(at->low, at->high);
    for (uint32_t i = at->begin; i < at->end; i++) {
      const node *root = &b->roots[b->boxes[i].corner[0]];
      vxm_box_join(at->low, at->high, root->low, root->high);
    }
    split(b, at, b->boxes, &next);
  }
  for (uint32_t r = 0; r < b->count; r++) {
    b->room[r] = next;
    next += (uint32_t)nodes_below(b->roots[r].end - b->roots[r].begin);
  }
}

/* ---- All of it ---- */

static size_t nodes_max(size_t triangles, size_t labels) {
  return 2 * labels + nodes_below(triangles) + 2 * LEAF;
}

uint64_t vxm_label_bvh_bytes(const vxm_face_labels *labelling) {
  uint64_t triangles = count_triangles(labelling), labels = labelling->table.count;
  return triangles * (sizeof(vxm_closest_triangle) + sizeof(item)) +
         nodes_max(triangles, labels) * sizeof(node) +
         labels * (sizeof(node) + sizeof(item) + 3 * sizeof(uint32_t)) + sizeof(vxm_label_bvh) + 2048;
}

static vxm_status allocate(builder *b, size_t triangles, vxm_error *error) {
  vxm_label_bvh *bvh = b->bvh;
  vxm_context *context = bvh->context;
  size_t labels = bvh->labelling->table.count;
  vxm_error local = VXM_ERROR_INIT;
  bvh->triangles = vxm_alloc(context, triangles, sizeof *bvh->triangles, &local);
  bvh->nodes = vxm_alloc(context, nodes_max(triangles, labels), sizeof *bvh->nodes, &local);
  bvh->root = vxm_alloc(context, labels, sizeof *bvh->root, &local);
  b->items = vxm_alloc(context, triangles, sizeof *b->items, &local);
  b->first = vxm_alloc(context, labels + 1, sizeof *b->first, &local);
  b->roots = vxm_alloc(context, labels, sizeof *b->roots, &local);
  b->room = vxm_alloc(context, labels, sizeof *b->room, &local);
  b->boxes = vxm_alloc(context, labels, sizeof *b->boxes, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static void free_builder(const builder *b) {
  vxm_context *context = b->bvh->context;
  vxm_free(context, b->boxes);
  vxm_free(context, b->room);
  vxm_free(context, b->roots);
  vxm_free(context, b->first);
  vxm_free(context, b->items);
}

static vxm_status build(vxm_label_bvh *bvh, size_t triangles, vxm_error *error) {
  builder b = {.bvh = bvh};
  vxm_status status = allocate(&b, triangles, error);
  if (status == VXM_OK)
    status = vxm_progress(bvh->context, "sorting faces", 0, error);
  if (status == VXM_OK)
    status = make_items(&b, error);
  if (status == VXM_OK) {
    make_roots(&b);
    if (b.count > 0) {
      grow_upper_tree(&b);
      vxm_parallel(bvh->context, b.count, grow_tree, &b);
    } else
      status = vxm_fail(error, VXM_ERROR_EMPTY, "no face has three corners that are finite");
  }
  free_builder(&b);
  return status;
}

vxm_status vxm_label_bvh_create(vxm_label_bvh **out, const vxm_face_labels *labelling, const vxm_space *space,
                                vxm_error *error) {
  vxm_context *context = labelling->soup->context;
  size_t triangles = count_triangles(labelling);
  *out = NULL;
  if (nodes_max(triangles, labelling->table.count) > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu triangles are too many to number; split the mesh",
                    triangles);
  vxm_error local = VXM_ERROR_INIT;
  vxm_label_bvh *bvh = vxm_calloc(context, 1, sizeof *bvh, &local);
  vxm_status status = local.code;
  if (bvh) {
    bvh->context = context;
    bvh->labelling = labelling;
    bvh->side = space->voxel_size[0];
    for (int a = 0; a < 3; a++) {
      bvh->origin[a] = space->origin[a];
      bvh->side = space->voxel_size[a] > bvh->side ? space->voxel_size[a] : bvh->side;
    }
    status = build(bvh, triangles, &local);
  }
  if (status == VXM_OK) {
    *out = bvh;
    return VXM_OK;
  }
  vxm_label_bvh_destroy(bvh);
  vxm_error_pass(error, &local);
  return status;
}
