/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about colours: they check arguments and call down. */
#include "base/sized.h"
#include "export/colors.h"
#include "export/volume_colors.h"
#include "voxel/labels/mesh_colors.h"

static vxm_status check(vxm_color_options *chosen, const vxm_space *space, const vxm_color_options *options,
                        vxm_error *error) {
  *chosen = (vxm_color_options)VXM_COLOR_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "colours", error);
  if (status != VXM_OK)
    return status;
  if ((unsigned)chosen->by > VXM_COLOR_VOLUME)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: %d is none of the functions", (int)chosen->by);
  if (chosen->by == VXM_COLOR_GLSL && !chosen->source)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: the source of the function is NULL");
  if (chosen->by == VXM_COLOR_MESH && !chosen->mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: the mesh that gives them is NULL");
  if (chosen->by == VXM_COLOR_VOLUME && !chosen->volume)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: the volume that gives them is NULL");
  if (chosen->by == VXM_COLOR_MESH)
    status = vxm_mesh_colors_check(chosen->mesh, error);
  if (status == VXM_OK)
    status = vxm_space_check(space, error);
  return status == VXM_OK && chosen->by == VXM_COLOR_VOLUME
             ? vxm_volume_colors_check(chosen->volume, space, error)
             : status;
}

vxm_status vxm_model_colors(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_color_options *options, vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!values || !model || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: an argument is NULL");
  vxm_color_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  vxm_voxelize_report made = {0};
  if (status == VXM_OK)
    status = vxm_colors_make(values, &made, model, space, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}

vxm_status vxm_model_write_colors(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                                  const char *path, const vxm_color_options *options, vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!model || !space || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: an argument is NULL");
  vxm_color_options chosen;
  vxm_voxelize_report made = {0};
  vxm_status status = check(&chosen, space, options, error);
  if (status == VXM_OK)
    status = vxm_colors_write(&made, model, space, path, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}
