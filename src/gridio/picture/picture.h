/* SPDX-License-Identifier: BSD-3-Clause */
/** Pictures of grids and of fields. */
#ifndef VXM_GRIDIO_PICTURE_PICTURE_H
#define VXM_GRIDIO_PICTURE_PICTURE_H

#include "gridio/common/values.h"
#include "gridio/picture/shade.h"

/**
 * Draws the grid into a PNG file.
 *
 * @param paint   the colours of its voxels, as payload `painted` has them; NULL = all have one
 * @param options not NULL
 * @return VXM_OK; VXM_ERROR_UNAVAILABLE without libpng; VXM_ERROR_ARGUMENT, VXM_ERROR_IO, VXM_ERROR_MEMORY,
 *         VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_gridio_picture(const vxm_grid *grid, vxm_paint_fn paint, const void *painted, const char *path,
                              const vxm_picture_options *options, vxm_error *error);

/** Draws a field; see vxm_field_picture in voxmend.h. @param options not NULL */
vxm_status vxm_gridio_field_picture(const vxm_field *field, const char *path,
                                    const vxm_picture_options *options,
                                    const vxm_threshold_options *threshold, vxm_error *error);

/** Whether a picture can be drawn so, and at all. */
vxm_status vxm_gridio_picture_check(const vxm_picture_options *options, vxm_error *error);

/** What numbers seem to be of which the file does not say it; VXM_FIELD_NUMBERS if that cannot be told. */
vxm_field_kind vxm_gridio_field_guess(const vxm_field *field, const vxm_field_range *range);
/** The voxels that are drawn without being told; VXM_ERROR_NUMBERS if what they are cannot be known. */
vxm_status vxm_gridio_field_shown(vxm_threshold_options *out, vxm_field_kind kind, const vxm_field *field,
                                  const vxm_field_range *range, vxm_error *error);

#endif
