/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The tree of a .vdb file, read where it lies: first the masks and tiles of all nodes, depth first, then the
 * values of the leaves in the same order. No tree is made, and nothing in the file is trusted: OpenVDB's own
 * reader would take a damaged length for true and write beyond its buffers.
 */
#ifndef VXM_GRIDIO_FORMATS_VDB_TREE_H
#define VXM_GRIDIO_FORMATS_VDB_TREE_H

#include "gridio/formats/vdb_file.h"

/** What is known of a tree before its values are read. */
typedef struct vxm_vdb_extent {
  bool is_empty;           /**< no active voxel; the box is then not set */
  int64_t low[3], high[3]; /**< active voxels, both included */
  uint64_t leaves;
  float background;
  size_t values; /**< offset of those of the leaves */
} vxm_vdb_extent;

/** Goes through the masks. VXM_ERROR_FORMAT with the offset of what is wrong. */
vxm_status vxm_vdb_tree_measure(vxm_vdb_extent *out, const vxm_vdb_grid *grid, const vxm_input *input,
                                vxm_error *error);

/** Takes what is set, or of a grid of floats the numbers; blocks and cubes do not overlap. */
typedef struct vxm_vdb_visitor {
  /** A block of 8 x 8 x 8: voxel (x,y,z) of it is bit 8 y + z of word x. */
  void (*block)(const int64_t at[3], const uint64_t bits[8], void *payload);
  /** A cube of which all voxels are set. */
  void (*cube)(const int64_t at[3], int64_t side, void *payload);
  /** A block of numbers, z fastest, then y, then x. */
  void (*numbers)(const int64_t at[3], const float numbers[512], void *payload);
  /** A cube of numbers that are alike, and not the background. */
  void (*number)(const int64_t at[3], int64_t side, float number, void *payload);
  void *payload;
} vxm_vdb_visitor;

/**
 * Reads all values, and reports progress as "reading".
 *
 * @return VXM_OK; VXM_ERROR_FORMAT with the offset of what is wrong; VXM_ERROR_UNAVAILABLE if values are
 *         packed and the module "openvdb" is not there; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_vdb_tree_visit(const vxm_vdb_visitor *visitor, const vxm_vdb_grid *grid,
                              const vxm_vdb_extent *extent, const vxm_input *input, vxm_error *error);

#endif
