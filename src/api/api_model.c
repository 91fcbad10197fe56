/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make many grids of one mesh: they check arguments and call down. */
#include "api/api_options.h"
#include "export/model_writer.h"
#include "voxel/model/voxelize.h"

#include <inttypes.h>
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
  vxm_status status = model->options.confidence ? vxm_grid_add_confidence(grid, error) : VXM_OK;
  return status == VXM_OK ? vxm_voxelize_into(grid, report, model, transform, error) : status;
}

static vxm_status check_write(const vxm_space *space, const char *path, const vxm_grid_write_options *options,
                              vxm_error *error) {
  if (!space || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  if (options && options->version != 1)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "write: options version %" PRIu32 " is unknown; use the initializer", options->version);
  return VXM_OK;
}

vxm_status vxm_model_estimate(vxm_estimate *out, const vxm_model *model, const vxm_space *space,
                              const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  if (out)
    *out = (vxm_estimate){0};
  if (!out || !model)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_status status = check_write(space, path, options, error);
  return status == VXM_OK
             ? vxm_model_writer_estimate(out, model, space, path, options ? options->format : NULL, error)
             : status;
}

vxm_status vxm_model_write(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                           const char *path, const vxm_grid_write_options *options, vxm_error *error) {
  vxm_voxelize_report local;
  if (!report)
    report = &local;
  *report = (vxm_voxelize_report){0};
  if (!model)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_status status = check_write(space, path, options, error);
  if (status == VXM_OK)
    status = vxm_model_writer_write(report, model, space, path, options ? options->format : NULL, error);
  if (status != VXM_OK)
    *report = (vxm_voxelize_report){0};
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
