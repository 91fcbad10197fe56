/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Makes a soup what the file will hold, so that all other passes work on that: triangles, and for .stl
 * positions that 32-bit floats hold.
 */
#include "repair/state/split.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

/** Moves the vertices of faces to the nearest positions that 32-bit floats hold. */
static vxm_status round_positions(vxm_repair_state *state, vxm_error *error) {
  vxm_soup *soup = state->soup;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    double *p = soup->positions + 3 * v;
    bool same = true;
    for (int a = 0; a < 3 && state->used[v]; a++) {
      if (isfinite(p[a]) && fabs(p[a]) > (double)FLT_MAX)
        return vxm_fail_at(
            error, VXM_ERROR_RANGE, (vxm_place){NULL, 0, -1, (int64_t)v},
            "vertex %zu lies at %g, beyond what 32-bit floats hold; write another format than stl", v, p[a]);
      double rounded = vxm_repair_state_round(state, p[a]);
      same = same && (rounded == p[a] || isnan(p[a]));
      p[a] = rounded;
    }
    if (!same)
      vxm_repair_state_note_vertex(state, VXM_PASS_ROUNDING, v);
    state->counts[VXM_PASS_ROUNDING] += !same;
  }
  return VXM_OK;
}

/** Comes after the passes that reduce faces and remove repeated ones, as these could not be seen any more
 * once polygons are triangles. */
vxm_status vxm_pass_rounding(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!state->options.single_precision && !state->options.triangles)
    return VXM_OK;
  int64_t before = state->counts[VXM_PASS_ROUNDING];
  vxm_status status = vxm_split_polygons(state, false, error);
  if (status == VXM_OK && state->options.single_precision)
    status = round_positions(state, error);
  *changed = state->counts[VXM_PASS_ROUNDING] > before;
  if (*changed)
    vxm_repair_state_move(state);
  return status;
}
