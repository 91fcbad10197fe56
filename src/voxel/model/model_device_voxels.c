/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model_device_voxels.h"

vxm_status vxm_device_voxels_create(vxm_device_voxels **out, vxm_engine *engine, const vxm_space *space,
                                    int64_t count, vxm_voxel_format format, vxm_error *error) {
  vxm_device_info shape = {.size = sizeof shape, .format = format, .count = count, .stayed = true};
  if (!engine || !engine->ops || !engine->ops->device_voxels)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "voxels stay on one device of OpenCL or OpenGL, and the engine is %s",
                    engine ? engine->info.name : "cpu");
  for (int a = 0; a < 3; a++)
    shape.dims[a] = space->dims[a];
  return engine->ops->device_voxels(engine, out, &shape, error);
}

/** Whether the engine makes all of a grid, without a look at its words in between. */
static bool can_stay(const vxm_model_pass *pass) {
  const vxm_voxel_pass *solid = &pass->solid;
  const vxm_voxelize_options *options = &solid->options;
  const vxm_engine_ops *ops = vxm_voxel_pass_ops(solid);
  if (pass->separating || solid->confidence || vxm_shell_wanted(options) ||
      options->method == VXM_METHOD_WINDING)
    return false;
  if (vxm_faces_wanted(options) && !ops->surface)
    return false;
  if (!vxm_solid_wanted(options))
    return true;
  if (!ops->unite)
    return false;
  /* What is contested, or lies in itself, is settled by the winding number, by the CPU. */
  if (vxm_overlaps_wanted(solid->analysis, options))
    return false;
  return !vxm_votes_wanted(solid->analysis, options) || (ops->vote && !vxm_caps_wanted(options));
}

static vxm_status keep_made_there(vxm_model_pass *pass, vxm_device_voxels *voxels, int64_t index,
                                  const vxm_window *window, vxm_error *error) {
  vxm_engine *engine = pass->solid.engine;
  vxm_status status = engine->ops->device_voxels_begin(engine, window, error);
  if (status != VXM_OK)
    return status;
  engine->keeps = true;
  status = vxm_model_pass_fill(pass, window, error);
  engine->keeps = false;
  return status == VXM_OK ? engine->ops->device_voxels_end(engine, voxels, index, window, error) : status;
}

static vxm_status keep_made_here(vxm_model_pass *pass, vxm_device_voxels *voxels, int64_t index,
                                 vxm_window *window, vxm_error *error) {
  vxm_engine *engine = pass->solid.engine;
  vxm_context *context = pass->solid.context;
  vxm_error local = VXM_ERROR_INIT;
  window->words =
      vxm_alloc(context, window->slice_words, (size_t)window->slow_dim * sizeof(uint64_t), &local);
  vxm_status status = window->words ? vxm_model_pass_fill(pass, window, &local) : local.code;
  if (status == VXM_OK)
    status = engine->ops->device_voxels_end(engine, voxels, index, window, &local);
  vxm_free(context, window->words);
  voxels->info.stayed = false;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_model_pass_keep_on_device(vxm_model_pass *pass, vxm_device_voxels *voxels, int64_t index,
                                         vxm_error *error) {
  vxm_engine *engine = pass->solid.engine;
  vxm_window window = vxm_window_of(&pass->space, voxels->layout, 0, pass->space.dims[voxels->layout.slow]);
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = VXM_ERROR_UNAVAILABLE;
  bool falls_back = engine->falls_back, stays = can_stay(pass);
  engine->falls_back = false; /* to what has no such voxels */
  engine->needs_host = false;
  if (stays)
    status = keep_made_there(pass, voxels, index, &window, &local);
  if (!stays || (status != VXM_OK && engine->needs_host))
    status = keep_made_here(pass, voxels, index, &window, &local);
  engine->falls_back = falls_back;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_voxelize_on_device(vxm_device_voxels **out, vxm_model *model, const vxm_space *space,
                                  const double transform[12], vxm_voxel_format format, vxm_error *error) {
  vxm_device_voxels *voxels = NULL;
  vxm_model_pass *pass = NULL;
  vxm_status status = vxm_device_voxels_create(&voxels, model->options.engine, space, 1, format, error);
  if (status == VXM_OK)
    status = vxm_model_begin(&pass, model, space, transform, NULL, error);
  if (status == VXM_OK)
    status = vxm_model_pass_keep_on_device(pass, voxels, 0, error);
  vxm_model_close(model, pass);
  if (status == VXM_OK)
    *out = voxels;
  else
    vxm_device_voxels_drop(voxels);
  return status;
}
