/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/bit_transpose.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/minecraft/blocks.h"
#include "gridio/gridio.h"
#include "gridio/mesh/coarse_positions.h"
#include "gridio/mesh/surface_mesh.h"
#include "meshio/meshio.h"

#include <stdio.h>
#include <string.h>

/** Word columns of the grid, each of which is up to 64 slices of a file that varies x slowest. */
static vxm_status put_planes(vxm_grid_writer *writer, const vxm_grid *grid, vxm_error *error) {
  vxm_bit_transpose planes;
  vxm_status status =
      vxm_bit_transpose_create(&planes, grid->context, &grid->space, vxm_grid_writer_layout(writer), error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    vxm_bit_transpose_gather(&planes, grid, w, NULL);
    vxm_window window = vxm_bit_transpose_window(&planes, grid, w);
    status = vxm_grid_writer_put(writer, &window, error);
  }
  vxm_bit_transpose_destroy(&planes);
  return status;
}

static vxm_status write_slices(const vxm_grid *grid, const char *path, const char *format, vxm_error *error) {
  vxm_grid_writer *writer;
  vxm_status status = vxm_grid_writer_open(&writer, grid->context, &grid->space, path, format, error);
  if (status != VXM_OK)
    return status;
  vxm_grid_writer_report(writer);
  if (vxm_layout_is_grid(vxm_grid_writer_layout(writer))) {
    vxm_window window = vxm_window_of_grid(grid);
    status = vxm_grid_writer_put(writer, &window, error);
  } else
    status = put_planes(writer, grid, error);
  if (status == VXM_OK)
    return vxm_grid_writer_commit(writer, error);
  vxm_grid_writer_abort(writer);
  return status;
}

/** Bits as a field of 0 and 1, for formats that need all of it. */
static vxm_status write_bytes(const vxm_grid *grid, const char *path, const vxm_grid_format *format,
                              vxm_style style, vxm_error *error) {
  vxm_field *field;
  vxm_status status =
      vxm_field_make(&field, grid->context, &grid->space, VXM_FIELD_NUMBERS, VXM_UINT8, error);
  if (status != VXM_OK)
    return status;
  vxm_field_put_grid(field, grid);
  field->style = style;
  if (format->check_field)
    status = format->check_field(field, path, error);
  if (status == VXM_OK)
    status = format->write_field(field, path, error);
  vxm_field_destroy(field);
  return status;
}

static vxm_status write_surface(const vxm_grid *grid, const char *path, const char *format, unsigned flags,
                                vxm_error *error) {
  vxm_soup *surface;
  vxm_status status = vxm_gridio_surface_mesh(&surface, grid, flags, error);
  if (status != VXM_OK)
    return status;
  status = vxm_check_coarse_positions(surface, &grid->space, strcmp(format, "stl") == 0, path, error);
  if (status == VXM_OK)
    status = vxm_meshio_write(surface, path, format, VXM_WRITE_POLYGONS, error);
  vxm_soup_destroy(surface);
  return status;
}

vxm_status vxm_style_of(vxm_style *out, const char *blocks, int up, vxm_error *error) {
  *out = (vxm_style){blocks, up};
  if (up < 0 || up > 3)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "up: %d is none of 0 to 3", up);
  return vxm_blocks_check_names(blocks, error);
}

vxm_status vxm_gridio_write_with(const vxm_grid *grid, const char *path,
                                 const vxm_grid_write_options *options, vxm_error *error) {
  vxm_style style;
  const vxm_grid_format *found = vxm_grid_format_for(path, options->format, error);
  if (!found || vxm_style_of(&style, options->blocks, options->up, error) != VXM_OK)
    return VXM_ERROR_ARGUMENT;
  unsigned flags = (options->keep_polygons ? 0 : VXM_SURFACE_MESH_TRIANGLES) |
                   (options->keep_contacts ? 0 : VXM_SURFACE_MESH_MANIFOLD);
  if (found->is_surface)
    return write_surface(grid, path, found->name, flags, error);
  return vxm_grid_format_streams(found) ? write_slices(grid, path, found->name, error)
                                        : write_bytes(grid, path, found, style, error);
}

vxm_status vxm_gridio_write(const vxm_grid *grid, const char *path, const char *format, vxm_error *error) {
  vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
  options.format = format;
  return vxm_gridio_write_with(grid, path, &options, error);
}

/* ---- Fields ---- */

vxm_status vxm_field_refuse(const vxm_field *field, const char *path, vxm_status status, const char *why,
                            vxm_error *error) {
  return vxm_fail_at(error, status, (vxm_place){path, 0, -1, -1}, "the field (%s, %s) %s",
                     vxm_field_kind_name(field->about.kind), vxm_scalar_name(field->scalar), why);
}

vxm_status vxm_field_check_labels(const vxm_field *field, const char *path, int max, const char *why,
                                  vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  if (field->channels == 4)
    return VXM_OK;
  vxm_status status = vxm_field_measure(&range, field, error);
  if (status == VXM_OK && (vxm_scalar_is_float(field->scalar) || range.min < 0 || range.max > max))
    status = vxm_field_refuse(field, path, VXM_ERROR_RANGE, why, error);
  return status;
}

vxm_status vxm_field_write_file(const vxm_field *field, const char *path,
                                vxm_status (*write)(vxm_output *output, const vxm_field *field,
                                                    vxm_error *error),
                                vxm_error *error) {
  vxm_output *output;
  vxm_status status = vxm_output_open(&output, field->context, path, error);
  if (status != VXM_OK)
    return status;
  status = write(output, field, error);
  if (status == VXM_OK || vxm_output_failed(output))
    return vxm_output_commit(output, error);
  vxm_output_abort(output);
  return status;
}

/** Whole numbers that are not said to be anything else may be labels. */
static bool holds_field(const vxm_grid_format *format, const vxm_field *field) {
  unsigned needs = vxm_field_needs(field);
  if (field->about.kind == VXM_FIELD_NUMBERS && !vxm_scalar_is_float(field->scalar))
    needs |= VXM_HOLDS_LABELS;
  return (format->holds & needs) != 0;
}

vxm_status vxm_gridio_write_field(const vxm_field *field, const char *path, const char *format,
                                  vxm_error *error) {
  const char *name = format ? format : vxm_path_extension(path);
  const vxm_grid_format *found = vxm_grid_format_chosen(path, format);
  char why[400];
  if (!found || !holds_field(found, field)) {
    snprintf(why, sizeof why, "cannot be written as \"%.20s\"; choose %s, or make bits of it by a threshold",
             name, vxm_grid_formats_holding(vxm_field_needs(field), "").text);
    return vxm_field_refuse(field, path, VXM_ERROR_ARGUMENT, why, error);
  }
  vxm_status status = found->check_field ? found->check_field(field, path, error) : VXM_OK;
  if (status != VXM_OK)
    return status;
  return found->write_field ? found->write_field(field, path, error)
                            : vxm_values_write_field(found->values, field, path, error);
}
