/* SPDX-License-Identifier: BSD-3-Clause */
/** Grid files in and out. doc/formats.md has the formats. */
#ifndef VXM_GRIDIO_GRIDIO_H
#define VXM_GRIDIO_GRIDIO_H

#include "gridio/common/values.h"
#include "voxmend/sparse.h"

/**
 * Reads a grid. The format is told by content first and by the extension second. What a file leaves out or
 * adds, but can be done without, becomes a warning of the grid.
 *
 * @param context not NULL
 * @param path    "-" reads standard input (not raw, which needs the JSON file beside it)
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_FORMAT with the byte offset; VXM_ERROR_NUMBERS for numbers that
 *         are not bits; VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED. The whole file is checked for length
 *         before the grid is allocated: a short file cannot ask for a large grid.
 */
vxm_status vxm_gridio_read(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error);
/** Reads a grid where the file stores bits, else a field; see vxm_grid_or_field_read in voxmend.h. */
vxm_status vxm_gridio_read_either(vxm_grid **grid, vxm_field **field, vxm_context *context, const char *path,
                                  vxm_error *error);
/** Reads only where the voxels lie; see vxm_grid_read_space in voxmend.h. */
vxm_status vxm_gridio_read_space(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error);
/** Reads an octree; see vxm_sparse_read in voxmend.h. */
vxm_status vxm_gridio_read_sparse(vxm_sparse **out, vxm_context *context, const char *path, vxm_error *error);

/**
 * Writes a grid; the file appears under its name when it is complete.
 *
 * @param path   "-" is standard output (not raw); format is then needed
 * @param format a name of vxm_grid_format_name, in any case; NULL = by the extension of `path`
 * @return VXM_OK; VXM_ERROR_ARGUMENT for an unknown format, and for binvox with voxels that are not cubes;
 *         VXM_ERROR_IO, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_gridio_write(const vxm_grid *grid, const char *path, const char *format, vxm_error *error);
/** As vxm_gridio_write, with options. */
vxm_status vxm_gridio_write_with(const vxm_grid *grid, const char *path,
                                 const vxm_grid_write_options *options, vxm_error *error);
/** How the options say that fields are shown. @return VXM_OK, VXM_ERROR_ARGUMENT for what cannot be */
vxm_status vxm_style_of(vxm_style *out, const char *blocks, int up, vxm_error *error);
/** Writes a field; see vxm_field_write in voxmend.h. @param format NULL = by the extension of `path` */
vxm_status vxm_gridio_write_field(const vxm_field *field, const char *path, const char *format,
                                  vxm_error *error);

#endif
