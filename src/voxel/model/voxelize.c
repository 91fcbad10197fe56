/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/voxelize.h"
#include "voxel/model/memory_need.h"
#include "voxel/model/model_report.h"

vxm_status vxm_voxelize_into(vxm_grid *grid, vxm_voxelize_report *report, vxm_model *model,
                             const double transform[12], vxm_error *error) {
  vxm_window window = vxm_window_of_grid(grid);
  vxm_model_pass *pass;
  vxm_status status = vxm_model_begin(&pass, model, &grid->space, transform, grid->confidence, error);
  if (status == VXM_OK)
    status = vxm_model_pass_fill(pass, &window, error);
  if (status == VXM_OK && report) {
    int64_t voxels;
    uint64_t hash;
    vxm_grid_count_hash(grid, &voxels, &hash);
    vxm_model_report(pass, report, voxels, hash);
  }
  vxm_model_close(model, pass);
  return status;
}

static vxm_status make_grid(vxm_grid **out, vxm_model *model, const vxm_space *space, vxm_error *error) {
  uint64_t bytes = (uint64_t)vxm_model_windows_held(model) * vxm_space_bytes(space);
  vxm_status status = vxm_memory_check(model->context, bytes, "voxelizing", error);
  if (status == VXM_OK)
    status = vxm_grid_create(out, model->context, space, error);
  if (status != VXM_OK || !model->options.confidence)
    return status;
  return vxm_grid_add_confidence(*out, error);
}

vxm_status vxm_voxelize_grid(vxm_grid **out, vxm_voxelize_report *report, vxm_model *model,
                             const vxm_space *space, vxm_error *error) {
  vxm_grid *grid = NULL;
  *out = NULL;
  vxm_status status = make_grid(&grid, model, space, error);
  if (status == VXM_OK)
    status = vxm_voxelize_into(grid, report, model, NULL, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  grid->warnings = vxm_model_results_read(model->results)->warnings;
  *out = grid;
  return VXM_OK;
}

vxm_status vxm_voxelize_run(vxm_grid **out, vxm_voxelize_report *report, const vxm_soup *soup,
                            const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error) {
  vxm_model *model = NULL;
  *out = NULL;
  vxm_status status = vxm_model_make(&model, soup, options, error);
  if (status == VXM_OK)
    status = vxm_voxelize_grid(out, report, model, space, error);
  vxm_model_destroy(model);
  return status;
}
