/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/distance_bvh.h"
#include "base/bits.h"
#include "base/box.h"
#include "base/cpu.h"
#include "base/threads.h"
#include "mesh/spatial_sort.h"
#include "voxel/closest/distance_bvh_tree.h"

#include <math.h>
#include <string.h>

enum { SLICES = 64 /**< of triangles and packs, for the threads */ };

typedef struct builder {
  vxm_distance_bvh *tree;
  vxm_distance_bvh_corners_fn corners;
  const void *payload;
  vxm_spatial_point *centroids; /**< the triangles, by three times their centroids */
  double (*boxes)[2][3];        /**< of the packs, then of the nodes of one level after the other */
  int level;                    /**< whose nodes are made */
} builder;

static void make_centroids(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  size_t end = vxm_slice_begin(b->tree->count, SLICES, slice + 1);
  for (size_t i = vxm_slice_begin(b->tree->count, SLICES, slice); i < end; i++) {
    double corner[3][3];
    b->corners(corner, i, b->payload);
    b->centroids[i].index = (uint32_t)i;
    for (int a = 0; a < 3; a++)
      b->centroids[i].at[a] = (float)(corner[0][a] + corner[1][a] + corner[2][a]);
  }
}

/* ---- Packs ---- */

/** A point in the middle of a box, and how far the box reaches from it. */
static float middle_of(double origin[3], double box[2][3]) {
  double reach2 = 0;
  for (int a = 0; a < 3; a++) {
    origin[a] = (box[0][a] + box[1][a]) / 2;
    double half = box[1][a] - origin[a];
    reach2 += half * half;
  }
  return (float)(sqrt(reach2) * (1 + 0x1p-20));
}

static void narrow_triangle(vxm_pack *pack, int lane, const vxm_distance_triangle *t) {
  for (int a = 0; a < 3; a++) {
    pack->base[a][lane] = (float)(t->base[a] - pack->origin[a]);
    for (int b = 0; b < 3; b++)
      pack->axis[a][b][lane] = (float)t->axis[a][b];
  }
  pack->length[lane] = (float)t->length;
  for (int i = 0; i < 2; i++) {
    pack->apex[i][lane] = (float)t->apex[i];
    pack->leg[i][0][lane] = (float)t->leg[i][0];
    pack->leg[i][1][lane] = (float)t->leg[i][1];
    pack->leg_length[i][lane] = (float)t->leg_length[i];
  }
}

static void make_pack(builder *b, size_t at) {
  vxm_distance_bvh *tree = b->tree;
  vxm_pack *pack = &tree->packs[at];
  size_t first = at * VXM_PACK, end = (size_t)vxm_min((int64_t)(first + VXM_PACK), (int64_t)tree->count);
  double(*box)[3] = b->boxes[at];
  vxm_box_empty(box[0], box[1]);
  for (size_t i = first; i < end; i++) {
    double corner[3][3];
    b->corners(corner, b->centroids[i].index, b->payload);
    vxm_distance_triangle_make(&tree->triangles[i], (const double(*)[3])corner);
    for (int c = 0; c < 3; c++)
      vxm_box_include(box[0], box[1], corner[c]);
  }
  pack->reach = middle_of(pack->origin, box);
  for (int lane = 0; lane < VXM_PACK; lane++) /* the last triangle fills up */
    narrow_triangle(pack, lane,
                    &tree->triangles[first + (size_t)lane < end ? first + (size_t)lane : end - 1]);
}

static void make_packs(size_t slice, int worker, void *payload) {
  (void)worker;
  builder *b = payload;
  size_t end = vxm_slice_begin(b->tree->pack_count, SLICES, slice + 1);
  for (size_t i = vxm_slice_begin(b->tree->pack_count, SLICES, slice); i < end; i++)
    make_pack(b, i);
}

/* ---- Nodes ---- */

/** Makes node `at` of the level at hand. Its own box takes the place of one that has been seen. */
static void make_node(builder *b, size_t at) {
  vxm_distance_bvh *tree = b->tree;
  vxm_bvh_node *node = &tree->nodes[b->level][at];
  size_t children = b->level > 0 ? tree->node_count[b->level - 1] : tree->pack_count;
  size_t first = at * VXM_PACK, count = children - first < VXM_PACK ? children - first : VXM_PACK;
  double box[2][3];
  memcpy(box, b->boxes[first], sizeof box);
  for (size_t c = 1; c < count; c++)
    vxm_box_join(box[0], box[1], b->boxes[first + c][0], b->boxes[first + c][1]);
  node->reach = middle_of(node->origin, box);
  node->valid = (uint32_t)vxm_low_bits((unsigned)count);
  for (size_t c = 0; c < VXM_PACK; c++)
    for (int a = 0; a < 3; a++) {
      double(*child)[3] = b->boxes[first + (c < count ? c : 0)];
      node->low[a][c] = (float)(child[0][a] - node->origin[a]);
      node->high[a][c] = (float)(child[1][a] - node->origin[a]);
    }
  memcpy(b->boxes[at], box, sizeof box);
}

static vxm_status make_nodes(builder *b, vxm_error *error) {
  vxm_distance_bvh *tree = b->tree;
  vxm_status status = VXM_OK;
  for (b->level = 0; b->level < tree->levels && status == VXM_OK; b->level++)
    for (size_t i = 0; i < tree->node_count[b->level] && status == VXM_OK; i++) {
      make_node(b, i);
      status = vxm_check_cancelled_at(i, tree->context, error);
    }
  return status;
}

/* ---- The tree ---- */

static size_t nodes_over(size_t children) {
  return (children + VXM_PACK - 1) / VXM_PACK;
}

uint64_t vxm_distance_bvh_bytes(size_t count) {
  uint64_t packs = nodes_over(count), nodes = packs / 7 + VXM_DISTANCE_BVH_LEVELS;
  return count * (sizeof(vxm_distance_triangle) + sizeof(vxm_spatial_point)) +
         packs * (sizeof(vxm_pack) + 6 * sizeof(double)) + nodes * sizeof(vxm_bvh_node) +
         sizeof(vxm_distance_bvh) + 4096;
}

/** Fails by its error, whatever could be had being freed with the tree. */
static void allocate(builder *b, vxm_error *error) {
  vxm_distance_bvh *tree = b->tree;
  vxm_context *context = tree->context;
  tree->pack_count = nodes_over(tree->count);
  tree->triangles = vxm_alloc(context, tree->count, sizeof *tree->triangles, error);
  tree->packs = vxm_alloc(context, tree->pack_count, sizeof *tree->packs, error);
  for (size_t n = tree->pack_count; tree->levels < 2 || n > 1; tree->levels++) {
    tree->node_count[tree->levels] = n = nodes_over(n);
    tree->nodes[tree->levels] = vxm_alloc(context, n, sizeof(vxm_bvh_node), error);
  }
  b->centroids = vxm_alloc(context, tree->count, sizeof *b->centroids, error);
  b->boxes = vxm_alloc(context, tree->pack_count, sizeof *b->boxes, error);
}

vxm_status vxm_distance_bvh_create(vxm_distance_bvh **out, vxm_context *context, size_t count,
                                   vxm_distance_bvh_corners_fn corners, const void *payload,
                                   vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_distance_bvh *tree = vxm_calloc(context, 1, sizeof *tree, &local);
  builder b = {.tree = tree, .corners = corners, .payload = payload};
  *out = NULL;
  if (tree) {
    tree->context = context;
    tree->count = count;
    allocate(&b, &local);
  }
  bool done = local.code == VXM_OK &&
              vxm_parallel_cancellable(context, SLICES, make_centroids, &b, &local) == VXM_OK &&
              vxm_spatial_sort(b.centroids, count, context, &local) == VXM_OK &&
              vxm_parallel_cancellable(context, SLICES, make_packs, &b, &local) == VXM_OK &&
              make_nodes(&b, &local) == VXM_OK;
  if (done)
    *out = tree;
  else
    vxm_error_pass(error, &local);
  vxm_free(context, b.boxes);
  vxm_free(context, b.centroids);
  if (local.code != VXM_OK)
    vxm_distance_bvh_destroy(tree);
  return local.code;
}

void vxm_distance_bvh_destroy(vxm_distance_bvh *tree) {
  if (!tree)
    return;
  for (int level = 0; level < tree->levels; level++)
    vxm_free(tree->context, tree->nodes[level]);
  vxm_free(tree->context, tree->packs);
  vxm_free(tree->context, tree->triangles);
  vxm_free(tree->context, tree);
}

/* ---- Searches ---- */

uint64_t vxm_distance_bvh_search_bytes(size_t count) {
  uint64_t leaves = nodes_over(nodes_over(count));
  return (leaves + nodes_over(leaves)) * sizeof(vxm_bvh_children) + sizeof(vxm_search) + 256;
}

vxm_status vxm_search_create(vxm_search **out, const vxm_distance_bvh *tree, vxm_error *error) {
  vxm_context *context = tree->context;
  vxm_error local = VXM_ERROR_INIT;
  vxm_search *search = vxm_calloc(context, 1, sizeof *search, &local);
  if (search) {
    search->tree = tree;
    search->tile_nodes = vxm_alloc(context, tree->node_count[1], sizeof *search->tile_nodes, &local);
    search->block_nodes = vxm_alloc(context, tree->node_count[0], sizeof *search->block_nodes, &local);
  }
  if (local.code != VXM_OK) {
    vxm_search_destroy(search);
    search = NULL;
    vxm_error_pass(error, &local);
  }
  *out = search;
  return local.code;
}

void vxm_search_destroy(vxm_search *search) {
  if (!search)
    return;
  vxm_context *context = search->tree->context;
  vxm_free(context, search->block_nodes);
  vxm_free(context, search->tile_nodes);
  vxm_free(context, search);
}

extern vxm_distance_bvh_tile_fn vxm_distance_bvh_tile_plain, vxm_distance_bvh_tile_avx2;

size_t vxm_distance_bvh_tile_all(vxm_distance_bvh_tile_fn *out[2]) {
  size_t count = 0;
  out[count++] = vxm_distance_bvh_tile_plain;
#if VXM_KERNELS_X86
  if (vxm_cpu_has_avx2())
    out[count++] = vxm_distance_bvh_tile_avx2;
#endif
  return count;
}

vxm_distance_bvh_tile_fn *vxm_distance_bvh_tile_best(void) {
  vxm_distance_bvh_tile_fn *all[2];
  return all[vxm_distance_bvh_tile_all(all) - 1];
}
