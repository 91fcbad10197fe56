/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/merge_places.h"

#include "mesh/weld.h"

vxm_status vxm_merge_map(vxm_context *context, const double *positions, size_t count, vxm_merge_rule rule,
                         uint32_t *map, vxm_error *error) {
  if (rule == VXM_MERGE_EXACT)
    return vxm_weld_exact(context, positions, count, map, NULL, error);
  vxm_error local = VXM_ERROR_INIT;
  double *places = vxm_alloc(context, 3 * count, sizeof *places, &local);
  for (size_t i = 0; places && i < 3 * count; i++)
    places[i] = vxm_merge_place(positions[i], rule);
  vxm_status status = places ? vxm_weld_exact(context, places, count, map, NULL, &local) : local.code;
  vxm_free(context, places);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
