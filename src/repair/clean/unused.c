/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/repair_state.h"

/** Removes the vertices of no face, keeping the order of the others, and renumbers the corners. */
vxm_status vxm_pass_unused(vxm_repair_state *state, bool *changed, vxm_error *error) {
  vxm_soup *soup = state->soup;
  vxm_status status = VXM_OK;
  *changed = false;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  if (extent.unused == 0)
    return VXM_OK;
  uint32_t *number = vxm_repair_state_scratch(state, soup->vertex_count, sizeof *number, &status, error);
  if (!number)
    return status;
  size_t kept = 0;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    if (!state->used[v]) {
      state->counts[VXM_PASS_UNUSED] += !state->gone[v];
      continue;
    }
    const double *from = vxm_position(soup, v);
    double *to = soup->positions + 3 * kept;
    for (int axis = 0; axis < 3; axis++)
      to[axis] = from[axis];
    number[v] = (uint32_t)kept++;
  }
  for (size_t c = 0; c < soup->corner_count; c++)
    soup->indices[c] = number[soup->indices[c]];
  soup->vertex_count = kept;
  for (size_t e = 0; state->has_edges && e < state->edges.count; e++) { /* which stay in order */
    vxm_edge *edge = &state->edges.edges[e];
    edge->a = number[edge->a];
    edge->b = number[edge->b];
  }
  vxm_free(state->context, number);
  vxm_repair_state_move(state);
  *changed = true;
  return VXM_OK;
}
