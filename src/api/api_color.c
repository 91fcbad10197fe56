/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about colours: they check arguments and call down. */
#include "export/colors.h"

#include <inttypes.h>

static vxm_status check(vxm_color_options *chosen, const vxm_space *space, const vxm_color_options *options,
                        vxm_error *error) {
  static const vxm_color_options defaults = VXM_COLOR_OPTIONS_INIT;
  *chosen = options ? *options : defaults;
  if (chosen->version != 1)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "colours: options version %" PRIu32 " is unknown; use the initializer", chosen->version);
  if ((unsigned)chosen->by > VXM_COLOR_GLSL)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: %d is none of the functions", (int)chosen->by);
  if (chosen->by == VXM_COLOR_GLSL && !chosen->source)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: the source of the function is NULL");
  return vxm_space_check(space, error);
}

vxm_status vxm_model_colors(uint8_t *values, vxm_voxelize_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_color_options *options, vxm_error *error) {
  vxm_voxelize_report local;
  report = report ? report : &local;
  *report = (vxm_voxelize_report){.parts = 0};
  if (!values || !model || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: an argument is NULL");
  vxm_color_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  return status == VXM_OK ? vxm_colors_run(values, report, model, space, &chosen, error) : status;
}

vxm_status vxm_model_write_colors(vxm_voxelize_report *report, vxm_model *model, const vxm_space *space,
                                  const char *path, const vxm_color_options *options, vxm_error *error) {
  vxm_voxelize_report local;
  report = report ? report : &local;
  *report = (vxm_voxelize_report){.parts = 0};
  if (!model || !space || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "colours: an argument is NULL");
  vxm_color_options chosen;
  vxm_status status = check(&chosen, space, options, error);
  if (status == VXM_OK)
    status = vxm_colors_write(report, model, space, path, &chosen, error);
  if (status != VXM_OK)
    *report = (vxm_voxelize_report){.parts = 0};
  return status;
}
