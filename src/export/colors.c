/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/colors.h"
#include "base/clock.h"
#include "export/volume_colors.h"
#include "gridio/common/format.h"
#include "gridio/gridio.h"
#include "voxel/labels/mesh_colors.h"
#include "voxel/model/voxelize.h"

/** The values, the grid and, where they are wanted, the parts. */
static vxm_status check_memory(const vxm_model *model, const vxm_space *space,
                               const vxm_color_options *options, vxm_error *error) {
  uint64_t voxels = (uint64_t)space->dims[0] * (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
  uint64_t bytes = voxels > UINT64_MAX / 8 ? UINT64_MAX : voxels * (vxm_color_wants_parts(options) ? 6 : 4);
  if (options->by == VXM_COLOR_MESH)
    bytes += vxm_mesh_colors_bytes(options->mesh, space, options->average);
  return vxm_memory_check(model->context, bytes, "a colour per voxel", error);
}

vxm_status vxm_colors_make(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const vxm_color_options *options, vxm_error *error) {
  vxm_grid *grid = NULL;
  if (options->by != VXM_COLOR_VOLUME)
    return vxm_colors_run(values, report, model, space, options, error);
  vxm_status status = vxm_voxelize_grid(&grid, report, model, space, error);
  if (status == VXM_OK)
    status = vxm_volume_colors(values, grid, options->volume, error);
  vxm_grid_destroy(grid);
  return status;
}

vxm_status vxm_colors_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_color_options *options, vxm_error *error) {
  double start = vxm_clock_ms();
  vxm_field *colors = NULL;
  const vxm_grid_format *format =
      vxm_grid_format_holding(path, options->format, VXM_HOLDS_COLORS, "colours go", error);
  vxm_style style;
  vxm_status status = format ? check_memory(model, space, options, error) : VXM_ERROR_ARGUMENT;
  if (status == VXM_OK)
    status = vxm_style_of(&style, options->blocks, options->up, error);
  if (status == VXM_OK)
    status = vxm_field_make(&colors, model->context, space, VXM_FIELD_COLORS, VXM_UINT8, error);
  if (status != VXM_OK)
    return status;
  colors->about.is_declared = true;
  colors->style = style;
  status = vxm_colors_make(colors->values, report, model, space, options, error);
  report->fill_ms = vxm_clock_ms() - start;
  if (status == VXM_OK)
    status = vxm_gridio_write_field(colors, path, format->name, error);
  report->write_ms = vxm_clock_ms() - start - report->fill_ms;
  vxm_field_destroy(colors);
  return status;
}
