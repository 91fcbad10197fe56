/* SPDX-License-Identifier: BSD-3-Clause */
/** One tile of an octree file on its way in. */
#ifndef VXM_GRIDIO_FORMATS_OCTREE_OCTREE_TILE_H
#define VXM_GRIDIO_FORMATS_OCTREE_OCTREE_TILE_H

#include "grid/octree_growth.h"
#include "gridio/formats/octree/octree_file.h"

/**
 * Adds tile `tile` of a file, whose first voxel is `at`, with all that is below its root.
 *
 * @return what growth->status is then: VXM_OK; VXM_ERROR_FORMAT with the byte where it is not an octree in
 * its one form: nodes whose children are mixed and full at once, or all alike; voxels beyond the dimensions;
 * a length or a number of voxels other than the index says; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_octree_add_tile(vxm_octree_growth *growth, const vxm_sparse_file *file, size_t tile,
                               const int64_t at[3]);

#endif
