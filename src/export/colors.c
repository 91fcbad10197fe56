/* SPDX-License-Identifier: BSD-3-Clause */
#include "export/colors.h"
#include "base/clock.h"
#include "export/volume_colors.h"
#include "gridio/formats/octree/octree_values.h"
#include "gridio/gridio.h"
#include "voxel/labels/color_nodes.h"
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

/** As a field, all of which is made first. */
static vxm_status write_field(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                              const char *path, const vxm_grid_format *format, vxm_style style,
                              const vxm_color_options *options, vxm_error *error) {
  double start = vxm_clock_ms();
  vxm_field *colors = NULL;
  vxm_status status = check_memory(model, space, options, error);
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

typedef struct volume {
  vxm_volume_sampler sampler;
  const vxm_space *space;
} volume;

static void color_by_volume(uint8_t value[4], const int64_t at[3], const void *payload) {
  const volume *v = payload;
  vxm_volume_color(value, &v->sampler, v->space, at);
}

/** As an octree, of which only what has voxels is made. */
static vxm_status write_octree(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                               const char *path, const vxm_color_options *options, vxm_error *error) {
  double start = vxm_clock_ms();
  const vxm_about about = {.is_declared = true, .kind = VXM_FIELD_COLORS};
  const vxm_values_spec values = {.scalar = VXM_UINT8, .channels = 4, .about = &about};
  bool by_volume = options->by == VXM_COLOR_VOLUME;
  volume source = {.space = space};
  vxm_color_nodes *nodes = NULL;
  vxm_values_writer writer = {0};
  if (by_volume)
    source.sampler = vxm_volume_sampler_of(options->volume);
  vxm_status status = vxm_color_nodes_create(&nodes, report, model, space, options,
                                             by_volume ? color_by_volume : NULL, &source, error);
  if (status == VXM_OK)
    status = vxm_values_writer_open(&writer, &vxm_octree_values, model->context, space, &values, path, error);
  if (status == VXM_OK) {
    vxm_node_maker maker = vxm_color_nodes_maker(nodes);
    status = vxm_octree_values_make(&writer, &maker, error);
  }
  vxm_color_nodes_destroy(nodes);
  report->fill_ms = vxm_clock_ms() - start;
  if (status == VXM_OK)
    status = vxm_values_writer_commit(&writer, error);
  vxm_values_writer_abort(&writer);
  report->write_ms = vxm_clock_ms() - start - report->fill_ms;
  return status;
}

vxm_status vxm_colors_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                            const char *path, const vxm_color_options *options, vxm_error *error) {
  const vxm_grid_format *format =
      vxm_grid_format_holding(path, options->format, VXM_HOLDS_COLORS, "colours go", error);
  vxm_style style;
  if (!format || vxm_style_of(&style, options->blocks, options->up, error) != VXM_OK)
    return VXM_ERROR_ARGUMENT;
  return format->values == &vxm_octree_values && vxm_color_nodes_are_for(model, options)
             ? write_octree(report, model, space, path, options, error)
             : write_field(report, model, space, path, format, style, options, error);
}
