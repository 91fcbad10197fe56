/* SPDX-License-Identifier: BSD-3-Clause */
/** The values of an octree file by nodes of 16 x 16 x 16 voxels, in any order. */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_READER_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_READER_H

#include "gridio/formats/octree/octree_values.h"

typedef struct vxm_octree_reader vxm_octree_reader;

/**
 * Reads the octree of a file that has values, checks these, and finds where those of each node stand.
 *
 * @param file must outlive it
 * @return VXM_OK; VXM_ERROR_FORMAT with the byte offset; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_octree_reader_create(vxm_octree_reader **out, const vxm_sparse_file *file, vxm_error *error);
/** NULL is allowed. */
void vxm_octree_reader_destroy(vxm_octree_reader *nodes);
/** The values of the node whose first voxel is `at`, in the machine's byte order, as vxm_node_maker.make. */
bool vxm_octree_reader_take(const vxm_octree_reader *nodes, const int64_t at[3], void *values);

#endif
