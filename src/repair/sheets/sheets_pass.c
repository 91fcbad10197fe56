/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/components.h"
#include "repair/sheets/thicken.h"
#include "repair/state/face_subset.h"
#include "repair/state/repair_state.h"

#include <math.h>

/** The thickness where none is given, as a fraction of the diagonal of the bounds. */
static const double DEFAULT_THICKNESS = 0.002;

/** At least so many units in the last place of the largest coordinate: what is thinner has no inside once it
 * is written. */
enum { UNITS = 16 };

static vxm_status find_thickness(double *out, vxm_repair_state *state, vxm_error *error) {
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  double largest = 0, given = state->options.thickness, diagonal = frame.diagonal / frame.scale;
  for (int i = 0; i < 6; i++)
    largest = fmax(largest, fabs(extent.bounds[i]));
  double unit = largest * (state->options.single_precision ? 0x1p-23 : 0x1p-52);
  *out = fmax(given > 0 ? given : DEFAULT_THICKNESS * diagonal, UNITS * unit);
  if (given > diagonal)
    return vxm_fail(
        error, VXM_ERROR_ARGUMENT,
        "sheets: a thickness of %g is more than the diagonal of the whole model, %g; give less, in "
        "model units",
        given, diagonal);
  return VXM_OK;
}

static bool is_asked_for(const vxm_repair_state *state) {
  return vxm_repair_state_reaches(state, VXM_LEVEL_CLOSED) && state->options.sheets != VXM_SHEETS_KEEP &&
         !(state->options.wrap_alpha > 0);
}

/** Marks the faces of components with an odd edge, and counts these. */
static vxm_status find_open(uint8_t *faces, int64_t *count, vxm_repair_state *state, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  vxm_status status = VXM_OK;
  size_t components;
  uint32_t *component = vxm_repair_state_scratch(state, soup->face_count, sizeof *component, &status, error);
  uint8_t *odd = component ? vxm_repair_state_scratch(state, soup->vertex_count, 1, &status, error) : NULL;
  uint8_t *open = odd ? vxm_repair_state_scratch(state, soup->face_count, 1, &status, error) : NULL;
  if (status == VXM_OK)
    status = vxm_components(state->context, soup, NULL, component, &components, error);
  for (size_t e = 0; e < state->edges.count && status == VXM_OK; e++)
    odd[state->edges.edges[e].a] |= vxm_edge_is_odd(&state->edges.edges[e]);
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      open[component[f]] |= odd[soup->indices[c]];
  *count = 0;
  for (size_t c = 0; status == VXM_OK && c < components; c++)
    *count += open[c];
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++)
    faces[f] = open[component[f]];
  vxm_free(state->context, open);
  vxm_free(state->context, odd);
  vxm_free(state->context, component);
  return status;
}

/** Parts of which nothing else is left are to go. */
static void note_dropped(vxm_repair_state *state, const uint8_t *sheets) {
  const vxm_soup *soup = state->soup;
  for (size_t f = 0; state->provenance && soup->face_parts && f < soup->face_count; f++)
    if (sheets[f])
      vxm_provenance_drop(state->provenance, soup->face_parts[f]);
}

/** Puts what the sheets become in their place. */
static vxm_status replace(vxm_repair_state *state, const uint8_t *sheets, vxm_error *error) {
  vxm_soup *rest;
  uint64_t *origin;
  vxm_status status = vxm_face_subset_create(&rest, &origin, state->soup, sheets, 0, error);
  if (status != VXM_OK)
    return status;
  size_t kept = rest->face_count;
  double thickness = 0;
  if (state->options.sheets == VXM_SHEETS_DROP)
    note_dropped(state, sheets);
  else
    status = find_thickness(&thickness, state, error);
  if (status == VXM_OK && state->options.sheets != VXM_SHEETS_DROP)
    status = vxm_thicken(rest, &origin, state->soup, sheets, thickness, error);
  if (status == VXM_OK) {
    state->counts[VXM_PASS_SHEETS] += (int64_t)(rest->face_count - kept);
    status = vxm_repair_state_adopt(state, rest, origin, error);
    if (status == VXM_OK)
      vxm_repair_state_mark_added(state, kept);
    return status;
  }
  vxm_soup_destroy(rest);
  vxm_free(state->context, origin);
  return status;
}

/** What is open still, once holes are filled, becomes plates or goes. */
vxm_status vxm_pass_sheets(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!is_asked_for(state))
    return VXM_OK;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.odd == 0)
    return status;
  int64_t count = 0;
  uint8_t *sheets = vxm_repair_state_scratch(state, state->soup->face_count, 1, &status, error);
  if (sheets)
    status = find_open(sheets, &count, state, error);
  if (status == VXM_OK)
    status = replace(state, sheets, error);
  vxm_free(state->context, sheets);
  if (status == VXM_OK) {
    state->sheets += count;
    state->open_parts = state->unfilled_holes = 0;
    *changed = true;
  }
  return status;
}
