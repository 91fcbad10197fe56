/* SPDX-License-Identifier: BSD-3-Clause */
/** Cross-sections of grids and fields as pictures. */
#ifndef VXM_GRIDIO_PICTURE_SLICE_H
#define VXM_GRIDIO_PICTURE_SLICE_H

#include "gridio/common/values.h"

/**
 * Draws the slice that the options choose.
 *
 * @param grid,field one of them is NULL
 * @param kind       of the field
 * @param range      of the field; NULL for a grid
 * @param options    checked, with a slice
 * @return as vxm_gridio_picture
 */
vxm_status vxm_gridio_slice(const vxm_grid *grid, const vxm_field *field, vxm_field_kind kind,
                            const vxm_field_range *range, const char *path,
                            const vxm_picture_options *options, vxm_error *error);

#endif
