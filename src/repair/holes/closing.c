/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/external/cgal.h"
#include "repair/external/openmesh.h"
#include "repair/holes/fill_fans.h"
#include "repair/holes/meeting_rims.h"
#include "repair/holes/rim_bands.h"
#include "repair/state/face_subset.h"
#include "repair/state/vertex_fans.h"

#include <string.h>

/** Edges that a hole may have to be filled; 0 = none is. */
static size_t largest_hole(const vxm_repair_options *options) {
  if (options->wrap_alpha > 0)
    return 0;
  if (options->fill_holes < 0 || (options->fill_holes == 0 && options->level >= VXM_LEVEL_CLOSED))
    return SIZE_MAX;
  return (size_t)options->fill_holes;
}

/* ---- By a module ---- */

/** Adds the faces marked as sheets, which the module has not seen, on vertices of their own. */
static vxm_status add_sheets(vxm_soup *filled, uint64_t **origin, const vxm_repair_state *state,
                             const uint8_t *sheets, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  vxm_error local = VXM_ERROR_INIT;
  size_t first = filled->vertex_count, total = filled->face_count + soup->face_count;
  uint64_t *grown = vxm_realloc(soup->context, *origin, total, sizeof *grown, &local);
  vxm_status status = local.code;
  if (grown)
    *origin = grown;
  if (status == VXM_OK)
    status = vxm_soup_add_vertices(filled, soup, &local);
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    if (!sheets[f])
      continue;
    (*origin)[filled->face_count] = f;
    status = vxm_soup_add_face(filled, corner, count, &local);
    for (size_t i = 0; i < count && status == VXM_OK; i++)
      filled->indices[filled->corner_count - count + i] += (uint32_t)first;
  }
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status call_module(vxm_soup **out, uint64_t **origin, vxm_repair_state *state,
                              const vxm_soup *soup, size_t most, vxm_error *error) {
  int64_t filled, left;
  size_t edges = most == SIZE_MAX ? 0 : most;
  vxm_status status;
  if (state->options.hole_fill == VXM_HOLE_FILL_SMOOTH) {
    const vxm_cgal *cgal;
    status = vxm_cgal_open(&cgal, "filling holes smoothly", error);
    if (status == VXM_OK)
      status = cgal->fill(out, origin, &filled, &left, soup, edges, error);
  } else {
    const vxm_openmesh *openmesh;
    status = vxm_openmesh_open(&openmesh, "filling holes with the least area", error);
    if (status == VXM_OK)
      status = openmesh->fill(out, origin, &filled, &left, soup, edges, error);
  }
  if (status == VXM_OK)
    state->unfilled_holes = left;
  if (status == VXM_OK)
    state->filled_holes += filled;
  return status;
}

/** What the modules fill has to be a manifold, which it is from that level on. */
static vxm_status check_manifold(vxm_repair_state *state, vxm_error *error) {
  bool manifold;
  vxm_status status = vxm_is_manifold(&manifold, state, error);
  if (status != VXM_OK || manifold)
    return status;
  return vxm_fail(
      error, VXM_ERROR_ARGUMENT,
      "some edge has more than two faces, or some vertex more than one fan: only --fill fan works there; "
      "choose that, or --level manifold");
}

/** Fills all but sheets, which stay as they are. */
static vxm_status fill_by_module(vxm_repair_state *state, const uint8_t *sheets, size_t most, bool *changed,
                                 vxm_error *error) {
  vxm_soup *rest, *filled = NULL;
  uint64_t *numbers, *origin = NULL;
  vxm_status status = check_manifold(state, error);
  if (status == VXM_OK)
    status = vxm_face_subset_create(&rest, &numbers, state->soup, sheets, 0, error);
  if (status != VXM_OK)
    return status;
  status = call_module(&filled, &origin, state, rest, most, error);
  if (status == VXM_OK) {
    int64_t added = (int64_t)filled->face_count - (int64_t)rest->face_count;
    for (size_t f = 0; f < filled->face_count; f++)
      origin[f] = origin[f] == VXM_NO_FACE ? VXM_NO_FACE : numbers[origin[f]];
    *changed |= added > 0;
    state->counts[VXM_PASS_CLOSING] += added;
    if (state->open_parts > 0)
      status = add_sheets(filled, &origin, state, sheets, error);
    if (status == VXM_OK && added > 0) {
      status = vxm_repair_state_adopt(state, filled, origin, error);
      filled = NULL;
      origin = NULL;
    }
  }
  vxm_soup_destroy(filled);
  vxm_free(state->context, origin);
  vxm_free(state->context, numbers);
  vxm_soup_destroy(rest);
  return status;
}

/** What a module leaves, such as rims that touch themselves, goes to fans. */
static vxm_status fan_the_rest(vxm_repair_state *state, size_t most, bool *changed, vxm_error *error) {
  int64_t closed = 0;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status == VXM_OK)
    status = vxm_fill_fans(state, most, &closed, error);
  state->fan_fallbacks += closed;
  state->filled_holes += closed;
  state->unfilled_holes = closed < state->unfilled_holes ? state->unfilled_holes - closed : 0;
  *changed |= closed > 0;
  return status;
}

/** Fills the holes whose rims meet others, which separation would mix up, by fans; before it. */
vxm_status vxm_pass_meeting_holes(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  size_t most = largest_hole(&state->options);
  if (most == 0 || !vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD))
    return VXM_OK;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.odd == 0)
    return status;
  int64_t closed;
  status = vxm_fill_meeting(state, most, &closed, error);
  *changed = closed > 0;
  state->filled_holes += closed;
  if (state->options.hole_fill != VXM_HOLE_FILL_FAN)
    state->fan_fallbacks += closed;
  return status;
}

/** Fills holes as the options say. Components that this would only cover a second time, sheets, stay open. */
vxm_status vxm_pass_closing(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  state->open_parts = 0;
  size_t most = largest_hole(&state->options);
  if (most == 0)
    return VXM_OK;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.odd == 0)
    return status;
  int64_t closed;
  status = vxm_fill_bands(state, most, &closed, error);
  state->filled_holes += closed;
  *changed = closed > 0;
  if (status == VXM_OK)
    status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.odd == 0)
    return status;
  if (state->options.hole_fill == VXM_HOLE_FILL_FAN) {
    status = vxm_fill_fans(state, most, &closed, error);
    *changed |= closed > 0;
    state->filled_holes += closed;
    return status;
  }
  uint8_t *sheets = vxm_repair_state_scratch(state, state->soup->face_count, sizeof *sheets, &status, error);
  if (sheets)
    status = vxm_find_sheets(sheets, state, error);
  if (status == VXM_OK)
    status = fill_by_module(state, sheets, most, changed, error);
  if (status == VXM_OK && state->unfilled_holes > 0)
    status = fan_the_rest(state, most, changed, error);
  vxm_free(state->context, sheets);
  return status;
}
