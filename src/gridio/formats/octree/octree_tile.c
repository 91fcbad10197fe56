/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/octree/octree_tile.h"
#include "base/endian.h"
#include "gridio/common/format.h"

/** A tile in the file. */
typedef struct tile_reader {
  vxm_octree_growth *growth;
  const vxm_sparse_file *file;
  uint64_t offset, end; /**< bytes that are still to be read */
  uint64_t voxels;      /**< so far */
} tile_reader;

static vxm_status fail(tile_reader *r, uint64_t offset, const char *what) {
  vxm_octree_growth *growth = r->growth;
  if (growth->status == VXM_OK)
    growth->status = vxm_fail_byte(growth->error, &r->file->input, offset, "%s: the file is damaged", what);
  return growth->status;
}

/** The next words of the tile, or NULL. */
static const unsigned char *take(tile_reader *r, uint64_t words) {
  const unsigned char *data = r->file->input.data + r->offset;
  if (words > (r->end - r->offset) / sizeof(uint64_t)) {
    fail(r, r->offset, "the tile ends before its nodes do");
    return NULL;
  }
  r->offset += words * sizeof(uint64_t);
  return data;
}

/** All children alike means that the node should not be there, but for the root of all. */
static bool is_sound(uint64_t mixed, uint64_t full, bool is_root) {
  bool alike = mixed == 0 && (full == 0 || full == ~UINT64_C(0));
  return (mixed & full) == 0 && (is_root || !alike);
}

/** Adds `count` nodes of a level, and gives the number of their mixed children. */
static size_t add_nodes(tile_reader *r, int level, size_t count) {
  vxm_octree_growth *growth = r->growth;
  uint64_t from = r->offset, cubes = 0, side = (uint64_t)vxm_octree_side(level);
  size_t children = 0, first = vxm_octree_growth_next(growth, level);
  bool is_root = level == growth->sparse->levels - 1;
  const unsigned char *data = take(r, 2 * (uint64_t)count);
  for (size_t n = 0; n < count && growth->status == VXM_OK; n++) {
    uint64_t mixed = vxm_load_le64(data + VXM_OCTREE_NODE * n);
    uint64_t full = vxm_load_le64(data + VXM_OCTREE_NODE * n + 8);
    if (!is_sound(mixed, full, is_root))
      fail(r, from + VXM_OCTREE_NODE * n, "a node has no children, or one both mixed and full");
    vxm_octree_growth_node(growth, level, mixed, full, first + children);
    children += (size_t)vxm_popcount(mixed);
    cubes += (uint64_t)vxm_popcount(full);
  }
  r->voxels += cubes * side * side * side;
  return children;
}

static void add_bricks(tile_reader *r, size_t count) {
  uint64_t from = r->offset;
  const unsigned char *data = take(r, count);
  for (size_t b = 0; b < count && r->growth->status == VXM_OK; b++) {
    uint64_t bits = vxm_load_le64(data + 8 * b);
    if (vxm_octree_growth_brick(r->growth, bits) != VXM_OCTREE_MIXED)
      fail(r, from + 8 * b, "a brick is empty or full");
    r->voxels += (uint64_t)vxm_popcount(bits);
  }
}

/** Whether a node has only voxels within the dimensions. */
static bool is_inside(const vxm_sparse *sparse, int level, size_t index, const int64_t at[3]) {
  const vxm_octree_node *node = &sparse->nodes[level][index];
  int64_t side = vxm_octree_side(level);
  for (uint64_t left = node->mixed | node->full; left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    const int64_t *n = sparse->space.dims;
    int64_t place[3];
    bool mixed = node->mixed >> child & 1, whole = true;
    vxm_octree_child_at(place, at, child, side);
    for (int a = 0; a < 3; a++)
      whole &= place[a] + side <= n[a];
    if (whole)
      continue;
    if (!mixed)
      return false;
    if (level > 0 && !is_inside(sparse, level - 1, vxm_octree_index(node, child), place))
      return false;
    if (level == 0 && (sparse->bricks[vxm_octree_index(node, child)] & ~vxm_octree_box(n, place)) != 0)
      return false;
  }
  return true;
}

vxm_status vxm_octree_add_tile(vxm_octree_growth *growth, const vxm_sparse_file *file, size_t tile,
                               const int64_t at[3]) {
  const unsigned char *entry = file->entries + VXM_OCTREE_ENTRY * tile;
  tile_reader r = {.growth = growth, .file = file, .offset = vxm_load_le64(entry), .end = file->index};
  uint64_t begin = r.offset;
  size_t root = growth->sparse->node_count[file->tile_level], count = 1;
  if (tile + 1 < file->tile_count)
    r.end = vxm_load_le64(entry + VXM_OCTREE_ENTRY);
  for (int l = file->tile_level; l >= 0 && growth->status == VXM_OK; l--)
    count = add_nodes(&r, l, count);
  if (growth->status == VXM_OK)
    add_bricks(&r, count);
  if (growth->status != VXM_OK)
    return growth->status;
  if (r.offset != r.end || r.voxels != vxm_octree_file_tile_voxels(file, tile))
    return fail(&r, begin, "the tile has not the bytes or the voxels that the index says");
  return is_inside(growth->sparse, file->tile_level, root, at)
             ? VXM_OK
             : fail(&r, begin, "the tile has voxels beyond the grid");
}
