/* SPDX-License-Identifier: BSD-3-Clause */
/** Octrees out: nodes of a tile lie together on every level, as all are in Morton order. */
#include "base/endian.h"
#include "gridio/formats/octree/octree_file.h"

/** What a tile has of a level: nodes begin..end-1, or bricks. */
typedef struct range {
  size_t begin, end;
} range;

/** Where a tile begins in the file, and its voxels. */
typedef struct entry {
  uint64_t offset, voxels;
} entry;

static void put_double(vxm_output *output, double number) {
  unsigned char bytes[8];
  vxm_store_double(bytes, number);
  vxm_output_write(output, bytes, sizeof bytes);
}

static size_t children_of(const vxm_octree_node *nodes, range r) {
  size_t count = 0;
  for (size_t n = r.begin; n < r.end; n++)
    count += (size_t)vxm_popcount(nodes[n].mixed);
  return count;
}

/** Voxels of the full children of nodes of a level, and of mixed bricks. */
static uint64_t count_voxels(const vxm_sparse *sparse, int level, range r) {
  uint64_t side = (uint64_t)vxm_octree_side(level), cubes = 0;
  for (size_t n = r.begin; n < r.end; n++)
    cubes += (uint64_t)vxm_popcount(sparse->nodes[level][n].full);
  return cubes * side * side * side;
}

static void put_nodes(vxm_output *output, const vxm_octree_node *nodes, range r) {
  for (size_t n = r.begin; n < r.end; n++) {
    vxm_octree_put_word(output, nodes[n].mixed);
    vxm_octree_put_word(output, nodes[n].full);
  }
}

/**
 * Writes the next tile.
 *
 * @param next where its nodes begin on each level, and at [0] its bricks: for level l at [l + 1]; moved on
 * @return voxels
 */
static uint64_t put_tile(vxm_output *output, const vxm_sparse *sparse, int level, size_t *next,
                         size_t *words) {
  uint64_t voxels = 0;
  size_t count = 1;
  *words = 0;
  for (int l = level; l >= 0; l--) {
    range r = {next[l + 1], next[l + 1] + count};
    put_nodes(output, sparse->nodes[l], r);
    voxels += count_voxels(sparse, l, r);
    next[l + 1] = r.end;
    *words += 2 * count;
    count = children_of(sparse->nodes[l], r);
  }
  for (size_t b = next[0]; b < next[0] + count; b++) {
    vxm_octree_put_word(output, sparse->bricks[b]);
    voxels += (uint64_t)vxm_popcount(sparse->bricks[b]);
  }
  next[0] += count;
  *words += count;
  return voxels;
}

static vxm_status put_tiles(vxm_output *output, entry *entries, const vxm_sparse *sparse, int level,
                            vxm_error *error) {
  size_t next[VXM_OCTREE_LEVELS + 1] = {0}, words, tiles = sparse->node_count[level];
  uint64_t offset = VXM_OCTREE_HEADER;
  for (size_t t = 0; t < tiles; t++) {
    entries[t] = (entry){offset, put_tile(output, sparse, level, next, &words)};
    offset += words * sizeof(uint64_t);
    if (vxm_output_failed(output))
      return VXM_OK; /* told when it is committed */
    if (t % 64 == 0) {
      vxm_status status = vxm_progress(sparse->context, "writing", (double)(t + 1) / (double)tiles, error);
      if (status != VXM_OK)
        return status;
    }
  }
  return VXM_OK;
}

static void put_index(vxm_output *output, const entry *entries, const vxm_sparse *sparse, int level) {
  for (int l = sparse->levels - 1; l > level; l--)
    put_nodes(output, sparse->nodes[l], (range){0, sparse->node_count[l]});
  for (size_t t = 0; t < sparse->node_count[level]; t++) {
    vxm_octree_put_word(output, entries[t].offset);
    vxm_octree_put_word(output, entries[t].voxels);
  }
}

/** The header comes first, and so the tiles are measured before they are written. */
static void put_header(vxm_output *output, const vxm_sparse *sparse, int level, uint64_t *values) {
  uint64_t voxels = 0, words = sparse->brick_count, upper = 0;
  for (size_t b = 0; b < sparse->brick_count; b++)
    voxels += (uint64_t)vxm_popcount(sparse->bricks[b]);
  for (int l = 0; l < sparse->levels; l++) {
    voxels += count_voxels(sparse, l, (range){0, sparse->node_count[l]});
    *(l <= level ? &words : &upper) += 2 * sparse->node_count[l];
  }
  vxm_output_write(output, "VXMOCT1\n", 8);
  for (int a = 0; a < 3; a++)
    vxm_octree_put_word(output, (uint64_t)sparse->space.dims[a]);
  for (int a = 0; a < 3; a++)
    put_double(output, sparse->space.origin[a]);
  for (int a = 0; a < 3; a++)
    put_double(output, sparse->space.voxel_size[a]);
  vxm_octree_put_word(output, voxels);
  vxm_octree_put_word(output, sparse->node_count[level]);
  vxm_octree_put_word(output, VXM_OCTREE_HEADER + 8 * words);
  if (values)
    *values =
        VXM_OCTREE_HEADER + 8 * (words + upper) + VXM_OCTREE_ENTRY * (uint64_t)sparse->node_count[level];
  vxm_octree_put_word(output, values ? *values : 0);
}

vxm_status vxm_octree_file_put(vxm_output *output, const vxm_sparse *sparse, uint64_t *values,
                               vxm_error *error) {
  int level = vxm_octree_tile_level(sparse->levels);
  vxm_error local = VXM_ERROR_INIT;
  entry *entries = vxm_alloc(sparse->context, sparse->node_count[level], sizeof *entries, &local);
  vxm_status status = local.code;
  put_header(output, sparse, level, values);
  if (status == VXM_OK)
    status = put_tiles(output, entries, sparse, level, &local);
  if (status == VXM_OK)
    put_index(output, entries, sparse, level);
  vxm_free(sparse->context, entries);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
