/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that read, write and draw grids: they check arguments and call down. */
#include "base/sized.h"
#include "grid/crop.h"
#include "gridio/formats/confidence.h"
#include "gridio/gridio.h"
#include "gridio/mesh/surface_mesh.h"
#include "gridio/page/page.h"
#include "gridio/picture/picture.h"

typedef vxm_status (*read_fn)(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error);

static vxm_status read_by(read_fn read, vxm_grid **out, vxm_context *context, const char *path,
                          vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = read(out, owner, path, error);
  vxm_context_release(owner);
  return status;
}

vxm_status vxm_grid_read(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error) {
  return read_by(vxm_gridio_read, out, context, path, error);
}

vxm_status vxm_grid_read_space(vxm_grid **out, vxm_context *context, const char *path, vxm_error *error) {
  return read_by(vxm_gridio_read_space, out, context, path, error);
}

vxm_status vxm_grid_write(const vxm_grid *grid, const char *path, const vxm_grid_write_options *options,
                          vxm_error *error) {
  if (!grid || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  vxm_grid_write_options chosen = VXM_GRID_WRITE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "grid", error);
  return status == VXM_OK ? vxm_gridio_write_with(grid, path, &chosen, error) : status;
}

vxm_status vxm_grid_surface_mesh(vxm_mesh **out, const vxm_grid *grid, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !grid)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  return vxm_gridio_surface_mesh(out, grid, VXM_SURFACE_MESH_MANIFOLD | VXM_SURFACE_MESH_TRIANGLES, error);
}

vxm_status vxm_grid_picture(const vxm_grid *grid, const char *path, const vxm_picture_options *options,
                            vxm_error *error) {
  if (!grid || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "picture: an argument is NULL");
  vxm_picture_options chosen = VXM_PICTURE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "picture", error);
  return status == VXM_OK ? vxm_gridio_picture(grid, NULL, NULL, path, &chosen, error) : status;
}

vxm_status vxm_grid_page(const vxm_grid *grid, const char *path, const vxm_page_options *options,
                         vxm_error *error) {
  if (!grid || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "page: an argument is NULL");
  vxm_page_options chosen = VXM_PAGE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "page", error);
  return status == VXM_OK ? vxm_gridio_page(grid, NULL, path, &chosen, NULL, error) : status;
}

vxm_status vxm_grid_write_confidence(const vxm_grid *grid, const char *path, vxm_error *error) {
  if (!grid || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "confidence: an argument is NULL");
  return vxm_gridio_confidence(grid, path, error);
}

vxm_status vxm_grid_window(vxm_grid **out, const vxm_grid *grid, const int64_t begin[3], const int64_t end[3],
                           vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !grid || !begin || !end)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  vxm_status status = vxm_space_check_box(&grid->space, begin, end, error);
  return status == VXM_OK ? vxm_grid_crop(out, grid, begin, end, error) : status;
}
