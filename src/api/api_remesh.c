/* SPDX-License-Identifier: BSD-3-Clause */
/** The public function that makes a surface anew: it checks arguments and calls down. */
#include "api/api_options.h"
#include "base/sized.h"
#include "remesh/remesh.h"

vxm_status vxm_mesh_remesh(vxm_mesh **out, vxm_voxelize_report *report, const vxm_mesh *mesh,
                           const vxm_space_options *space_options, const vxm_voxelize_options *options,
                           vxm_error *error) {
  if (out)
    *out = NULL;
  VXM_RESULT_CLEAR(report);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "remesh: an argument is NULL");
  vxm_voxelize_options chosen;
  vxm_voxelize_report made = {0};
  vxm_space space;
  vxm_status status = vxm_choose_voxelize_options(&chosen, options, error);
  if (status == VXM_OK && (chosen.mode != VXM_MODE_SOLID || chosen.confidence))
    status = vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "remesh: a surface is made of the solid (VXM_MODE_SOLID), without confidence");
  if (status == VXM_OK)
    status = vxm_space_fit(&space, mesh, space_options, error);
  if (status == VXM_OK)
    status = vxm_remesh(out, &made, mesh, &space, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}
