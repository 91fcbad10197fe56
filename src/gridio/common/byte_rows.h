/* SPDX-License-Identifier: BSD-3-Clause */
/** For formats with a byte per voxel, 0 or 1: the rows of windows as bytes. */
#ifndef VXM_GRIDIO_COMMON_BYTE_ROWS_H
#define VXM_GRIDIO_COMMON_BYTE_ROWS_H

#include "gridio/common/values_writer.h"

/** What the state of such a format takes (vxm_grid_writer_kind.state_bytes). */
size_t vxm_byte_rows_bytes(const vxm_space *space, vxm_layout layout);
/** Writes the slices of a window (vxm_grid_writer_kind.put), on the threads of the context. */
vxm_status vxm_byte_rows_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error);
/** The same for formats that take numbers (vxm_grid_writer.values), some of which want whole slices. */
size_t vxm_byte_rows_values_bytes(const vxm_values_writer_kind *kind, const vxm_space *space);
vxm_status vxm_byte_rows_put_values(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error);

#endif
