/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/repair_state.h"

/** Marks the vertices with a NaN or an infinity as gone. */
static int64_t mark_vertices(vxm_repair_state *state) {
  int64_t count = 0;
  for (size_t v = 0; v < state->soup->vertex_count; v++)
    if (!vxm_is_finite(vxm_position(state->soup, v))) {
      count += !state->gone[v];
      state->gone[v] = 1;
      vxm_repair_state_note_vertex(state, VXM_PASS_NONFINITE, v);
    }
  return count;
}

/** Removes the faces of vertices that are not finite. */
vxm_status vxm_pass_nonfinite(vxm_repair_state *state, bool *changed, vxm_error *error) {
  int64_t count = mark_vertices(state);
  *changed = count > 0;
  state->counts[VXM_PASS_NONFINITE] += count;
  if (count == 0)
    return VXM_OK;
  vxm_status status = VXM_OK;
  vxm_soup *soup = state->soup;
  uint8_t *remove = vxm_repair_state_scratch(state, soup->face_count, sizeof *remove, &status, error);
  if (!remove)
    return status;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t corners;
    const uint32_t *face = vxm_face(soup, f, &corners);
    for (size_t i = 0; i < corners && !remove[f]; i++)
      remove[f] = state->gone[face[i]];
  }
  vxm_repair_state_remove_faces(state, remove);
  vxm_free(state->context, remove);
  return VXM_OK;
}
