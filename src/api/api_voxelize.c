/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make grids from meshes: they check arguments and call down. */
#include "api/api_options.h"
#include "base/sized.h"
#include "grid/space.h"
#include "mesh/soup.h"
#include "voxel/model/voxelize.h"

vxm_status vxm_space_fit(vxm_space *out, const vxm_mesh *mesh, const vxm_space_options *options,
                         vxm_error *error) {
  if (out)
    *out = (vxm_space){.dims = {0}};
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxel space: an argument is NULL");
  vxm_space_options chosen = VXM_SPACE_OPTIONS_INIT;
  vxm_space space = {0};
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "voxel space", error);
  if (status == VXM_OK)
    status = vxm_space_choose(&space, mesh, &chosen, error);
  if (status == VXM_OK)
    *out = space;
  return status;
}

vxm_status vxm_choose_voxelize_options(vxm_voxelize_options *chosen, const vxm_voxelize_options *options,
                                       vxm_error *error) {
  *chosen = (vxm_voxelize_options)VXM_VOXELIZE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(chosen, options, "voxelize", error);
  if (status != VXM_OK)
    return status;
  options = chosen;
  if ((unsigned)options->method > VXM_METHOD_WINDING)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: method %d is unknown", (int)options->method);
  if ((unsigned)options->vote > VXM_VOTE_ALL)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: vote %d is unknown", (int)options->vote);
  if ((unsigned)options->mode > VXM_MODE_BOTH)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: mode %d is unknown", (int)options->mode);
  if ((unsigned)options->surface > VXM_SURFACE_SHELL6)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: surface %d is unknown", (int)options->surface);
  if ((unsigned)options->cavities > VXM_CAVITIES_FILL)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: cavities %d is unknown", (int)options->cavities);
  if ((unsigned)options->split_mode > VXM_SPLIT_MODE_WHOLE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: parts %d is unknown", (int)options->split_mode);
  if ((unsigned)options->thin > VXM_THIN_KEEP26)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: thin %d is unknown", (int)options->thin);
  return VXM_OK;
}

vxm_status vxm_voxelize(vxm_grid **out, vxm_voxelize_report *report, const vxm_mesh *mesh,
                        const vxm_space_options *space_options, const vxm_voxelize_options *options,
                        vxm_error *error) {
  if (out)
    *out = NULL;
  VXM_RESULT_CLEAR(report);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_voxelize_options chosen;
  vxm_voxelize_report made = {0};
  vxm_space space;
  vxm_status status = vxm_choose_voxelize_options(&chosen, options, error);
  if (status == VXM_OK)
    status = vxm_space_fit(&space, mesh, space_options, error);
  if (status == VXM_OK)
    status = vxm_voxelize_run(out, &made, mesh, &space, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}
