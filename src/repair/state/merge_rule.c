/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/merge_rule.h"

#include "mesh/weld.h"

vxm_status vxm_merge_map(vxm_context *context, const double *positions, size_t count, vxm_merge_rule rule,
                         uint32_t *map, vxm_error *error) {
  if (rule == VXM_MERGE_EXACT)
    return vxm_weld_exact(context, positions, count, map, NULL, error);
  vxm_error local = VXM_ERROR_INIT;
  double *rounded = vxm_alloc(context, 3 * count, sizeof *rounded, &local);
  for (size_t i = 0; rounded && i < 3 * count; i++)
    rounded[i] = vxm_merge_coordinate(positions[i], rule);
  vxm_status status = rounded ? vxm_weld_exact(context, rounded, count, map, NULL, &local) : local.code;
  vxm_free(context, rounded);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
