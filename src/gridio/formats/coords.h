/* SPDX-License-Identifier: BSD-3-Clause */
/** Lists of the coordinates of set voxels. */
#ifndef VXM_GRIDIO_FORMATS_COORDS_H
#define VXM_GRIDIO_FORMATS_COORDS_H

#include "grid/octree.h"

/** See vxm_sparse_write_coords in voxmend.h. */
vxm_status vxm_gridio_coords_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error);
vxm_status vxm_gridio_coords_grid(const vxm_grid *grid, const char *path, vxm_error *error);

#endif
