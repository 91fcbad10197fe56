/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make many grids of one mesh: they check arguments and call down. */
#include "api/api_options.h"
#include "base/sized.h"
#include "export/model_writer.h"
#include "voxel/model/voxelize.h"

vxm_status vxm_model_create(vxm_model **out, const vxm_mesh *mesh, const vxm_voxelize_options *options,
                            vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "model: an argument is NULL");
  vxm_voxelize_options chosen;
  vxm_status status = vxm_choose_voxelize_options(&chosen, options, error);
  return status == VXM_OK ? vxm_model_make(out, mesh, &chosen, error) : status;
}

vxm_status vxm_model_voxelize(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                              const double transform[12], vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!grid || !model)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_voxelize_report made = {0};
  vxm_status status = model->options.confidence ? vxm_grid_add_confidence(grid, error) : VXM_OK;
  if (status == VXM_OK)
    status = vxm_voxelize_into(grid, report ? &made : NULL, model, transform, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}

static vxm_status check_write(vxm_grid_write_options *chosen, const vxm_space *space, const char *path,
                              const vxm_grid_write_options *options, vxm_error *error) {
  *chosen = (vxm_grid_write_options)VXM_GRID_WRITE_OPTIONS_INIT;
  if (!space || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  return VXM_OPTIONS_READ(chosen, options, "write", error);
}

vxm_status vxm_model_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                              const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !model)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_grid_write_options chosen;
  vxm_estimate made = {0};
  vxm_status status = check_write(&chosen, space, path, options, error);
  if (status == VXM_OK)
    status = vxm_model_writer_estimate(&made, model, space, path, chosen.format, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(out, &made);
  return status;
}

vxm_status vxm_model_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                           const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!model)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_grid_write_options chosen;
  vxm_voxelize_report made = {0};
  vxm_status status = check_write(&chosen, space, path, options, error);
  if (status == VXM_OK)
    status = vxm_model_writer_write(&made, model, space, path, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}

int64_t vxm_model_warning_count(const vxm_model *model) {
  const vxm_model_result *result = model ? vxm_model_results_read(model->results) : NULL;
  return result ? result->warnings.count : 0;
}

const char *vxm_model_warning(const vxm_model *model, int64_t index) {
  const vxm_model_result *result = model ? vxm_model_results_read(model->results) : NULL;
  return result && index >= 0 && index < result->warnings.count ? result->warnings.text[index] : "";
}
