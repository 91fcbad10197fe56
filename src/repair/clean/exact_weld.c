/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/repair_state.h"

#include "mesh/weld.h"

/** Merges every vertex into the first one of the same position. */
vxm_status vxm_pass_exact_weld(vxm_repair_state *state, bool *changed, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_soup *soup = state->soup;
  *changed = false;
  uint32_t *map = vxm_repair_state_scratch(state, soup->vertex_count, sizeof *map, &status, error);
  if (!map)
    return status;
  status = vxm_weld_exact(state->context, soup->positions, soup->vertex_count, map, NULL, error);
  if (status == VXM_OK) {
    int64_t count = vxm_repair_state_merge(state, map);
    state->counts[VXM_PASS_EXACT_WELD] += count;
    *changed = count > 0;
  }
  vxm_free(state->context, map);
  return status;
}
