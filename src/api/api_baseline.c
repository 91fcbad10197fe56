/* SPDX-License-Identifier: BSD-3-Clause */
/** The public function of the published methods: it checks arguments and calls down. */
#include "base/sized.h"
#include "experimental/baseline.h"

vxm_status vxm_baseline_voxelize(vxm_grid *grid, vxm_baseline_report *report, const vxm_mesh *mesh,
                                 const vxm_baseline_options *options, vxm_error *error) {
  VXM_RESULT_CLEAR(report);
  if (!grid || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "baseline: an argument is NULL");
  vxm_baseline_options chosen = VXM_BASELINE_OPTIONS_INIT;
  vxm_baseline_report made = {0};
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "baseline", error);
  if (status != VXM_OK)
    return status;
  if ((unsigned)chosen.method > VXM_BASELINE_EISEMANN)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "baseline: method %d is unknown", (int)chosen.method);
  if (!(chosen.radius >= 0 && chosen.radius <= 1000))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "baseline: radius %g is not a number of voxels from 0 to 1000",
                    chosen.radius);
  status = vxm_baseline_run(grid, &made, mesh, &chosen, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}
