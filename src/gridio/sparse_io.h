/* SPDX-License-Identifier: BSD-3-Clause */
/** Files of octrees, and lists of voxels. */
#ifndef VXM_GRIDIO_SPARSE_IO_H
#define VXM_GRIDIO_SPARSE_IO_H

#include "grid/octree.h"

/** See vxm_sparse_write in voxmend.h; `format` NULL = by the extension. */
vxm_status vxm_gridio_write_sparse(const vxm_sparse *sparse, const char *path, const char *format,
                                   vxm_error *error);

/** See vxm_sparse_write_coords in voxmend.h. */
vxm_status vxm_gridio_coords_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error);
vxm_status vxm_gridio_coords_grid(const vxm_grid *grid, const char *path, vxm_error *error);

#endif
