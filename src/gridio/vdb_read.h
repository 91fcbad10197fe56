/* SPDX-License-Identifier: BSD-3-Clause */
/** .vdb files in: bool and mask grids, level sets and fog volumes as set voxels. */
#ifndef VXM_GRIDIO_VDB_READ_H
#define VXM_GRIDIO_VDB_READ_H

#include "grid/bitgrid.h"
#include "gridio/vdb_file.h"

/** The reader of the format (vxm_grid_format.read). */
vxm_status vxm_vdb_read(vxm_grid **out, const vxm_input *input, vxm_error *error);

#endif
