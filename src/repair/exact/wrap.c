/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/exact/wrap.h"

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

vxm_status vxm_wrap_soup(vxm_soup **out, uint64_t **nearest, vxm_soup *soup, double alpha, double offset,
                         vxm_error *error) {
  const vxm_cgal *cgal;
  vxm_extent extent;
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  *nearest = NULL;
  if (vxm_extent_find(&extent, soup->context, soup, &local) == VXM_OK &&
      vxm_cgal_open(&cgal, "wrapping a mesh", &local) == VXM_OK) {
    vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
    double size = alpha * frame.diagonal, distance = offset > 0 ? offset * frame.diagonal : size / 30;
    shrink(soup, frame.scale);
    if (cgal->wrap(out, nearest, soup, size, distance, &local) == VXM_OK)
      regrow(*out, frame.scale);
    regrow(soup, frame.scale);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

/** The last resort, which always gives a closed surface: one that is laid around everything. */
vxm_status vxm_pass_wrap(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  const vxm_repair_options *options = &state->options;
  if (!(options->wrap_alpha > 0) || state->soup->face_count == 0)
    return VXM_OK;
  vxm_soup *soup;
  uint64_t *nearest;
  vxm_status status =
      vxm_wrap_soup(&soup, &nearest, state->soup, options->wrap_alpha, options->wrap_offset, error);
  if (status != VXM_OK)
    return status;
  state->counts[VXM_PASS_WRAP] += (int64_t)soup->face_count;
  *changed = true;
  /* The tags are those of what lies beneath; parts are no longer told apart. */
  vxm_free(state->context, state->soup->face_parts);
  state->soup->face_parts = NULL;
  return vxm_repair_state_adopt(state, soup, nearest, error);
}
