/* SPDX-License-Identifier: BSD-3-Clause */
/** What the index of an octree file tells without its tiles. */
#include "base/endian.h"
#include "gridio/formats/octree/octree_file.h"

uint64_t vxm_octree_file_tile_voxels(const vxm_sparse_file *file, size_t tile) {
  return vxm_load_le64(file->entries + VXM_OCTREE_ENTRY * tile + 8);
}

typedef struct walk {
  const vxm_sparse_file *file;
  const vxm_octree_counts *box; /**< NULL = only the sum is wanted */
  uint64_t voxels;
  bool is_inside; /**< no full node reaches beyond the grid */
} walk;

static void add_full(walk *w, const int64_t at[3], int64_t side) {
  for (int a = 0; a < 3; a++)
    w->is_inside &= at[a] + side <= w->file->space.dims[a];
  w->voxels += (uint64_t)side * (uint64_t)side * (uint64_t)side;
  if (w->box)
    vxm_octree_count_cube(w->box, at, side);
}

static void add_tile(walk *w, size_t tile, const int64_t at[3]) {
  uint64_t voxels = vxm_octree_file_tile_voxels(w->file, tile);
  w->voxels += voxels;
  if (w->box)
    vxm_octree_count_some(w->box, at, voxels);
}

static bool meets(const walk *w, const int64_t at[3], int64_t side) {
  bool yes = true;
  for (int a = 0; a < 3 && w->box; a++)
    yes &= at[a] < w->box->end[a] * w->box->side && at[a] + side > w->box->begin[a] * w->box->side;
  return yes;
}

static void walk_node(walk *w, int level, size_t index, const int64_t at[3]) {
  const vxm_octree_node *node = &w->file->nodes[level][index];
  int64_t side = vxm_octree_side(level);
  for (uint64_t left = node->mixed | node->full; left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    int64_t place[3];
    vxm_octree_child_at(place, at, child, side);
    if (!meets(w, place, side))
      continue;
    if (node->full >> child & 1)
      add_full(w, place, side);
    else if (level - 1 == w->file->tile_level)
      add_tile(w, vxm_octree_index(node, child), place);
    else
      walk_node(w, level - 1, vxm_octree_index(node, child), place);
  }
}

static void walk_index(walk *w) {
  const int64_t origin[3] = {0, 0, 0};
  if (w->file->tile_level == w->file->levels - 1)
    add_tile(w, 0, origin);
  else
    walk_node(w, w->file->levels - 1, 0, origin);
}

bool vxm_octree_file_count_voxels(uint64_t *voxels, const vxm_sparse_file *file) {
  walk w = {.file = file, .is_inside = true};
  walk_index(&w);
  *voxels = w.voxels;
  return w.is_inside;
}

void vxm_octree_file_count(const vxm_octree_counts *box, const vxm_sparse_file *file) {
  walk w = {.file = file, .box = box};
  walk_index(&w);
}
