/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/unit_scale.h"
#include "repair/external/cgal.h"
#include "repair/state/repair_state.h"

/** Into the frame of the bounds: the wrap computes with products of lengths, which overflow or vanish where
 * models are huge or tiny. All is multiplied by a power of two, which changes no digit. */
static void shrink(vxm_soup *soup, double scale) {
  for (size_t i = 0; i < 3 * soup->vertex_count; i++)
    soup->positions[i] *= scale;
}

/** Back again; the inverse of the scale might be beyond the numbers. */
static void regrow(vxm_soup *soup, double scale) {
  for (size_t i = 0; i < 3 * soup->vertex_count; i++)
    soup->positions[i] /= scale;
}

/** The last resort, which always gives a closed surface: one that is laid around everything. */
vxm_status vxm_pass_wrap(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!(state->options.wrap_alpha > 0) || state->soup->face_count == 0)
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  double alpha = state->options.wrap_alpha * frame.diagonal;
  double offset = state->options.wrap_offset > 0 ? state->options.wrap_offset * frame.diagonal : alpha / 30;
  const vxm_cgal *cgal;
  vxm_soup *soup;
  uint64_t *nearest;
  vxm_status status = vxm_cgal_open(&cgal, "wrapping a mesh", error);
  if (status != VXM_OK)
    return status;
  shrink(state->soup, frame.scale);
  status = cgal->wrap(&soup, &nearest, state->soup, alpha, offset, error);
  if (status != VXM_OK)
    return status;
  regrow(soup, frame.scale);
  state->counts[VXM_PASS_WRAP] += (int64_t)soup->face_count;
  *changed = true;
  /* The tags are those of what lies beneath; parts are no longer told apart. */
  vxm_free(state->context, state->soup->face_parts);
  state->soup->face_parts = NULL;
  return vxm_repair_state_adopt(state, soup, nearest, error);
}
