/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/bit_transpose.h"
#include "gridio/common/format.h"
#include "gridio/gridio.h"
#include "gridio/mesh/surface_mesh.h"
#include "meshio/meshio.h"

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

static vxm_status write_surface(const vxm_grid *grid, const char *path, const char *format, unsigned how,
                                vxm_error *error) {
  vxm_soup *surface;
  vxm_status status = vxm_gridio_surface_mesh(&surface, grid, how, error);
  if (status != VXM_OK)
    return status;
  status = vxm_meshio_write(surface, path, format, VXM_WRITE_POLYGONS, error);
  vxm_soup_destroy(surface);
  return status;
}

vxm_status vxm_gridio_write_with(const vxm_grid *grid, const char *path,
                                 const vxm_grid_write_options *options, vxm_error *error) {
  const vxm_grid_format *found = vxm_grid_format_for(path, options->format, error);
  if (!found)
    return VXM_ERROR_ARGUMENT;
  unsigned how = (options->keep_polygons ? 0 : VXM_SURFACE_TRIANGLES) |
                 (options->keep_contacts ? 0 : VXM_SURFACE_MANIFOLD);
  return found->writer ? write_slices(grid, path, found->name, error)
                       : write_surface(grid, path, found->name, how, error);
}

vxm_status vxm_gridio_write(const vxm_grid *grid, const char *path, const char *format, vxm_error *error) {
  vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
  options.format = format;
  return vxm_gridio_write_with(grid, path, &options, error);
}
