/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/cut_nonmanifold.h"
#include "repair/state/split.h"
#include "repair/state/vertex_fans.h"

/** The separated soup has the faces of the present one, in their order. */
static vxm_status adopt(vxm_repair_state *state, vxm_soup *soup, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint64_t *origin = vxm_repair_state_scratch(state, soup->face_count, sizeof *origin, &status, error);
  if (!origin) {
    vxm_soup_destroy(soup);
    return status;
  }
  for (size_t f = 0; f < soup->face_count; f++)
    origin[f] = f;
  return vxm_repair_state_adopt(state, soup, origin, error);
}

/**
 * Makes the faces a manifold: cuts them apart, on vertices of their own at the same positions, where an edge
 * or vertex has too many. No face is lost; a polygon that touches itself becomes triangles. What is manifold
 * already stays as it is.
 */
vxm_status vxm_pass_cut_nonmanifold(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD) || state->options.wrap_alpha > 0)
    return VXM_OK;
  bool manifold;
  vxm_status status = vxm_is_manifold(&manifold, state, error);
  if (status != VXM_OK || manifold)
    return status;
  vxm_soup *soup;
  int64_t split, stitched;
  status = vxm_split_polygons(state, true, error);
  if (status == VXM_OK)
    status = vxm_cut_nonmanifold(&soup, &split, &stitched, state->soup, error);
  if (status != VXM_OK)
    return status;
  state->counts[VXM_PASS_CUT_NONMANIFOLD] += split;
  *changed = true;
  return adopt(state, soup, error);
}
