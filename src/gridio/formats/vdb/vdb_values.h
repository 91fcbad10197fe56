/* SPDX-License-Identifier: BSD-3-Clause */
/** .vdb of numbers (vxm_grid_format.check_field, write_field and values). */
#ifndef VXM_GRIDIO_FORMATS_VDB_VDB_VALUES_H
#define VXM_GRIDIO_FORMATS_VDB_VDB_VALUES_H

#include "gridio/common/values_writer.h"

vxm_status vxm_vdb_check_field(const vxm_field *field, const char *path, vxm_error *error);
vxm_status vxm_vdb_write_field(const vxm_field *field, const char *path, vxm_error *error);
/** 32-bit floats as they are made. */
extern const vxm_values_writer_kind vxm_vdb_values;

#endif
