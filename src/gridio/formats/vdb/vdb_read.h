/* SPDX-License-Identifier: BSD-3-Clause */
/** .vdb files in, through OpenVDB in a process of its own: bool and mask grids as set voxels, floats as
 * numbers. */
#ifndef VXM_GRIDIO_FORMATS_VDB_VDB_READ_H
#define VXM_GRIDIO_FORMATS_VDB_VDB_READ_H

#include "gridio/common/values.h"
#include "voxmend/sparse.h"

/** Whether the content is that of the format (vxm_grid_format.sniff). */
bool vxm_vdb_sniff(const vxm_input *input);
/** The reader of the format (vxm_grid_format.read). */
vxm_status vxm_vdb_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
/** And of numbers (vxm_grid_format.read_field), for grids of floats. */
vxm_status vxm_vdb_read_field(vxm_field **out, const vxm_input *input, vxm_error *error);
/** And of octrees (vxm_grid_format.read_sparse), for bool and mask grids; VXM_ERROR_NUMBERS for floats. */
vxm_status vxm_vdb_read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error);

#endif
