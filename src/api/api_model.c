/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make many grids of one mesh: they check arguments and call down. */
#include "api/api_options.h"
#include "gridio/gridio.h"
#include "voxel/voxelize.h"

#include <string.h>

vxm_status vxm_model_create(vxm_model **out, const vxm_mesh *mesh, const vxm_voxelize_options *options,
                            vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "model: an argument is NULL");
  vxm_voxelize_options chosen = VXM_VOXELIZE_OPTIONS_INIT;
  if (options)
    chosen = *options;
  vxm_status status = vxm_check_voxelize_options(&chosen, error);
  return status == VXM_OK ? vxm_model_make(out, mesh, &chosen, error) : status;
}

vxm_status vxm_model_voxelize(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                              const double transform[12], vxm_error *error) {
  if (report)
    memset(report, 0, sizeof *report);
  if (!grid || !model)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  return vxm_voxelize_into(grid, report, model, transform, error);
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
