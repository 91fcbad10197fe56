/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .octree: an octree (grid/octree.h) as a file, of which a part can be read without the rest. doc/formats.md
 * has every byte.
 *
 * Nodes of up to level VXM_OCTREE_TILE_LEVEL stand together with all below them, as a tile. The nodes above,
 * and where each tile begins, are the index at the end of the file. Of a node only the words `mixed` and
 * `full` are in the file: `first` comes from counting. All words are little-endian.
 */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_FILE_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_FILE_H

#include "base/endian.h"
#include "base/output.h"
#include "grid/octree_count.h"
#include "grid/octree_growth.h"

enum {
  VXM_OCTREE_TILE_LEVEL = 2, /**< a tile is 256 x 256 x 256 voxels; the whole where that is less */
  VXM_OCTREE_HEADER = 112,   /**< bytes */
  VXM_OCTREE_NODE = 16,      /**< bytes of a node in the file */
  VXM_OCTREE_ENTRY = 16      /**< bytes of a tile in the index: where it begins, and how many voxels it has */
};

/** An open file. Reading parts of it does not change it. */
struct vxm_sparse_file {
  vxm_context *context; /**< one reference held */
  char *name;
  vxm_input input;
  vxm_space space;
  uint64_t voxels;
  int levels, tile_level;
  uint64_t index;                            /**< byte at which the index begins, and the last tile ends */
  vxm_octree_node *nodes[VXM_OCTREE_LEVELS]; /**< above tiles */
  size_t node_count[VXM_OCTREE_LEVELS];
  const unsigned char *entries;
  size_t tile_count;
  uint64_t values;     /**< byte at which they begin, and the index ends; 0 = the octree has none */
  vxm_field_kind kind; /**< of the values, as is all below */
  vxm_scalar scalar;
  int channels;
  unsigned char background[8]; /**< in the machine's order */
  const unsigned char *blocks; /**< where each begins, and the last ends */
  uint64_t block_count;
};

bool vxm_octree_sniff(const vxm_input *input);

/** The level of a tile's root. */
static inline int vxm_octree_tile_level(int levels) {
  return levels - 1 < VXM_OCTREE_TILE_LEVEL ? levels - 1 : VXM_OCTREE_TILE_LEVEL;
}

/** See vxm_sparse_file_open in voxmend.h: reads header and index. @param input taken over, also after a
 * failure
 */
vxm_status vxm_octree_file_open(vxm_sparse_file **out, vxm_input *input, vxm_error *error);

/** An octree of the whole space with the tiles that meet a box, and nothing else; the box has been checked.
 */
vxm_status vxm_octree_file_load(vxm_sparse **out, const vxm_sparse_file *file, const int64_t begin[3],
                                const int64_t end[3], vxm_error *error);

/** Voxels of a tile, as the index tells it. */
uint64_t vxm_octree_file_tile_voxels(const vxm_sparse_file *file, size_t tile);
/** Sums the voxels that the index tells. @return whether all that is full in it is within the grid */
bool vxm_octree_file_count_voxels(uint64_t *voxels, const vxm_sparse_file *file);
/** Adds what the index alone tells, to cubes that are not smaller than tiles. */
void vxm_octree_file_count(const vxm_octree_counts *box, const vxm_sparse_file *file);

static inline void vxm_octree_put_word(vxm_output *output, uint64_t word) {
  word = vxm_le64(word);
  vxm_output_write(output, &word, sizeof word);
}

/**
 * Writes an octree into an output. A failed write is told when that is committed.
 *
 * @param[out] values NULL, or the values that the caller writes behind it begin at this byte
 * @return VXM_OK, VXM_ERROR_CANCELLED, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_octree_file_put(vxm_output *output, const vxm_sparse *sparse, uint64_t *values,
                               vxm_error *error);

#endif
