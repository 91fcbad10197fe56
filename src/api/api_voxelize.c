/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that make grids from meshes: they check arguments and call down. */
#include "api/api_options.h"
#include "grid/space.h"
#include "mesh/soup.h"
#include "voxel/model/voxelize.h"

#include <inttypes.h>
#include <string.h>

vxm_status vxm_space_fit(vxm_space *out, const vxm_mesh *mesh, const vxm_space_options *options,
                         vxm_error *error) {
  if (out)
    memset(out, 0, sizeof *out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxel space: an argument is NULL");
  vxm_space_options defaults = VXM_SPACE_OPTIONS_INIT;
  vxm_space space = {0};
  vxm_status status = vxm_space_choose(&space, mesh, options ? options : &defaults, error);
  if (status == VXM_OK)
    *out = space;
  return status;
}

vxm_status vxm_check_voxelize_options(const vxm_voxelize_options *options, vxm_error *error) {
  if (options->version != 1)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "voxelize: options version %" PRIu32 " is unknown; use the initializer",
                    options->version);
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
  if ((unsigned)options->parts > VXM_PARTS_WHOLE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: parts %d is unknown", (int)options->parts);
  return VXM_OK;
}

vxm_status vxm_voxelize(vxm_grid **out, vxm_voxelize_report *report, const vxm_mesh *mesh,
                        const vxm_voxelize_options *options, vxm_error *error) {
  if (out)
    *out = NULL;
  vxm_voxelize_report local;
  if (!report)
    report = &local;
  memset(report, 0, sizeof *report);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: an argument is NULL");
  vxm_voxelize_options chosen = VXM_VOXELIZE_OPTIONS_INIT;
  if (options)
    chosen = *options;
  vxm_space space;
  vxm_status status = vxm_check_voxelize_options(&chosen, error);
  if (status == VXM_OK)
    status = vxm_space_choose(&space, mesh, &chosen.space, error);
  if (status == VXM_OK)
    status = vxm_voxelize_run(out, report, mesh, &space, &chosen, error);
  if (status != VXM_OK)
    memset(report, 0, sizeof *report);
  return status;
}
