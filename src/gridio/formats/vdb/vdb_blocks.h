/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels gathered into the blocks of which OpenVDB makes a tree (vdb.h). */
#ifndef VXM_GRIDIO_FORMATS_VDB_VDB_BLOCKS_H
#define VXM_GRIDIO_FORMATS_VDB_VDB_BLOCKS_H

#include "grid/octree.h"
#include "gridio/formats/vdb/vdb.h"

/** Where blocks go. */
typedef struct vxm_vdb_target {
  const vxm_vdb_functions *functions;
  vxm_vdb *vdb;
} vxm_vdb_target;

/**
 * Puts slices begin to begin + 7 of a window, fewer at the end of the space.
 *
 * @param window in VXM_LAYOUT_GRID
 * @param begin  a multiple of 8
 * @return what the module returns
 */
vxm_status vxm_vdb_put_slab(const vxm_vdb_target *target, const vxm_window *window, int64_t begin,
                            vxm_error *error);

/** Puts all of an octree, and reports progress as "writing". */
vxm_status vxm_vdb_put_octree(const vxm_vdb_target *target, const vxm_sparse *sparse, vxm_error *error);

#endif
