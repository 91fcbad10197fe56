/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make many grids of one mesh. */
#include "grid/bitgrid.h"
#include "gridio/gridio.h"
#include "mesh/soup.h"
#include "voxel/voxelize.h"

#include <string.h>

struct vxm_model {
  vxm_context *context;
  const vxm_mesh *mesh;
  vxm_voxelize_options options;
  vxm_notes notes;
};

vxm_status vxm_model_create(vxm_model **out, const vxm_mesh *mesh, const vxm_voxelize_options *options,
                            vxm_error *error) {
  vxm_voxelize_options chosen = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_error local = VXM_ERROR_INIT;
  vxm_model *model = vxm_calloc(mesh->context, 1, sizeof *model, &local);
  (void)error;
  model->context = mesh->context;
  model->mesh = mesh;
  model->options = options ? *options : chosen;
  *out = model;
  return VXM_OK;
}

void vxm_model_destroy(vxm_model *model) {
  if (model)
    vxm_free(model->context, model);
}

vxm_status vxm_model_voxelize(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                              const double transform[12], vxm_error *error) {
  vxm_voxelize_report local;
  (void)transform;
  vxm_grid *made;
  vxm_voxelize_options options = model->options;
  options.space.like = &grid->space;
  vxm_status status = vxm_voxelize(&made, report ? report : &local, model->mesh, &options, error);
  if (status != VXM_OK)
    return status;
  memcpy(grid->words, made->words, grid->word_count * 8);
  model->notes = made->notes;
  vxm_grid_destroy(made);
  return VXM_OK;
}

vxm_status vxm_model_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                              const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  (void)model, (void)path, (void)options, (void)error;
  *out = (vxm_estimate){vxm_space_bytes(space), vxm_space_bytes(space), 1};
  return VXM_OK;
}

vxm_status vxm_model_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                           const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  vxm_grid *grid;
  vxm_status status = vxm_grid_create(&grid, model->context, space, error);
  if (status != VXM_OK)
    return status;
  status = vxm_model_voxelize(grid, report, model, NULL, error);
  if (status == VXM_OK)
    status = vxm_grid_write(grid, path, options, error);
  vxm_grid_destroy(grid);
  return status;
}

int64_t vxm_model_warning_count(const vxm_model *model) {
  return model->notes.count;
}

const char *vxm_model_warning(const vxm_model *model, int64_t index) {
  return index >= 0 && index < model->notes.count ? model->notes.text[index] : "";
}
