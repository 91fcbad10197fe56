/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/components.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"
#include "repair/exact/wrap.h"
#include "repair/state/face_subset.h"
#include "repair/state/repair_state.h"
#include "repair/state/self_intersections.h"

/** A component whose volume is this part of that of a cube of its area, or less, has none. */
static const double NO_VOLUME = 1e-9;

typedef struct choosing {
  vxm_repair_state *state;
  vxm_face_pairs pairs; /**< faces that cut through each other */
  uint32_t *component;  /**< per face */
  size_t count;
  uint8_t *chosen; /**< per component */
} choosing;

/** Chooses the components without a volume, which cannot be united with anything, of those that `cross`. */
static vxm_status choose_flat(choosing *c, const uint8_t *cross, vxm_error *error) {
  const vxm_soup *soup = c->state->soup;
  vxm_status status = VXM_OK;
  double(*sums)[2] = vxm_repair_state_scratch(c->state, c->count, sizeof *sums, &status, error);
  const double **from =
      sums ? vxm_repair_state_scratch(c->state, c->count, sizeof *from, &status, error) : NULL;
  vxm_extent extent;
  vxm_repair_state_extent(c->state, &extent);
  double scale = vxm_unit_scale_of(extent.bounds).scale;
  for (size_t f = 0; from && f < soup->face_count; f++) {
    size_t count;
    uint32_t own = c->component[f];
    const uint32_t *corner = vxm_face(soup, f, &count);
    if (!from[own] && count > 0)
      from[own] = vxm_position(soup, corner[0]);
    vxm_vec3 area;
    sums[own][1] += vxm_face_cone(&area, soup, f, from[own], scale);
    sums[own][0] += vxm_vec3_length(area);
  }
  for (size_t i = 0; from && i < c->count; i++)
    c->chosen[i] |= cross[i] && fabs(sums[i][1]) <= NO_VOLUME * pow(sums[i][0], 1.5);
  vxm_free(c->state->context, (void *)from);
  vxm_free(c->state->context, sums);
  return status;
}

/** Chooses those that cut through themselves, and where neither that nor a missing volume is the reason why
 * two could not be united, both. */
static vxm_status choose(choosing *c, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint8_t *cross = vxm_repair_state_scratch(c->state, c->count, 1, &status, error);
  for (size_t i = 0; cross && i < c->pairs.count; i++) {
    uint32_t a = c->component[c->pairs.pairs[i].first], b = c->component[c->pairs.pairs[i].second];
    c->chosen[a] |= a == b;
    cross[a] = cross[b] = 1;
  }
  if (cross)
    status = choose_flat(c, cross, error);
  for (size_t i = 0; cross && status == VXM_OK && i < c->pairs.count; i++) {
    uint32_t a = c->component[c->pairs.pairs[i].first], b = c->component[c->pairs.pairs[i].second];
    if (!c->chosen[a] && !c->chosen[b])
      cross[a] = cross[b] = 2;
  }
  for (size_t i = 0; cross && i < c->count; i++)
    c->chosen[i] |= cross[i] == 2;
  vxm_free(c->state->context, cross);
  return status;
}

/** Marks the faces of the components that are to be wrapped, and counts these. */
static vxm_status mark_chosen(uint8_t *faces, int64_t *count, vxm_repair_state *state, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  choosing c = {.state = state};
  vxm_status status = vxm_self_intersections_find(&c.pairs, soup, VXM_CROSSINGS_MOST, error);
  if (status == VXM_OK)
    c.component = vxm_repair_state_scratch(state, soup->face_count, sizeof *c.component, &status, error);
  if (c.component)
    status = vxm_components(state->context, soup, NULL, c.component, &c.count, error);
  if (status == VXM_OK)
    c.chosen = vxm_repair_state_scratch(state, c.count, 1, &status, error);
  if (c.chosen)
    status = choose(&c, error);
  *count = 0;
  for (size_t i = 0; i < c.count && status == VXM_OK; i++)
    *count += c.chosen[i];
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++)
    faces[f] = c.chosen[c.component[f]];
  vxm_free(state->context, c.chosen);
  vxm_free(state->context, c.component);
  vxm_free(state->context, c.pairs.pairs);
  return status;
}

/** Puts the faces of a wrap behind the others, and says where each comes from. */
static vxm_status append(vxm_soup *rest, uint64_t **origin, const vxm_soup *wrap, const uint64_t *nearest,
                         const uint64_t *numbers, vxm_error *error) {
  size_t first = rest->vertex_count, faces = rest->face_count + wrap->face_count;
  vxm_error local = VXM_ERROR_INIT;
  uint64_t *grown = vxm_realloc(rest->context, *origin, faces, sizeof *grown, &local);
  if (grown)
    *origin = grown;
  if (local.code == VXM_OK)
    vxm_soup_add_vertices(rest, wrap, &local);
  for (size_t f = 0; f < wrap->face_count && local.code == VXM_OK; f++) {
    uint32_t corners[3];
    for (int i = 0; i < 3; i++)
      corners[i] = (uint32_t)(wrap->indices[3 * f + (size_t)i] + first);
    (*origin)[rest->face_count] = numbers[nearest[f]];
    vxm_soup_add_face(rest, corners, 3, &local);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static vxm_status wrap_marked(vxm_repair_state *state, const uint8_t *faces, vxm_error *error) {
  vxm_soup *parts = NULL, *rest = NULL, *wrap = NULL;
  uint64_t *numbers = NULL, *origin = NULL, *nearest = NULL;
  vxm_status status = vxm_face_subset_create(&parts, &numbers, state->soup, faces, 1, error);
  if (status == VXM_OK)
    status = vxm_wrap_soup(&wrap, &nearest, parts, state->options.fallback_alpha, 0, error);
  if (status == VXM_OK)
    status = vxm_face_subset_create(&rest, &origin, state->soup, faces, 0, error);
  if (status == VXM_OK)
    status = append(rest, &origin, wrap, nearest, numbers, error);
  if (status == VXM_OK) {
    state->counts[VXM_PASS_WRAP] += (int64_t)wrap->face_count;
    size_t first = rest->face_count - wrap->face_count;
    status = vxm_repair_state_adopt(state, rest, origin, error);
    rest = NULL;
    origin = NULL;
    if (status == VXM_OK)
      vxm_repair_state_mark_added(state, first);
  }
  vxm_free(state->context, nearest);
  vxm_soup_destroy(wrap);
  vxm_free(state->context, origin);
  vxm_soup_destroy(rest);
  vxm_free(state->context, numbers);
  vxm_soup_destroy(parts);
  return status;
}

/** Wraps the parts that are in the way of a union, where that was asked for; they have names still, but no
 * volumes to compare. */
vxm_status vxm_pass_fallback(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!(state->options.fallback_alpha > 0))
    return VXM_OK;
  int64_t count = 0;
  vxm_status status = VXM_OK;
  uint8_t *faces = vxm_repair_state_scratch(state, state->soup->face_count, 1, &status, error);
  if (faces)
    status = mark_chosen(faces, &count, state, error);
  if (status == VXM_OK && count > 0) {
    status = wrap_marked(state, faces, error);
    *changed = true;
    state->wrapped_parts += count;
    state->union_failures = 0;
    if (state->provenance)
      vxm_provenance_forget_left(state->provenance);
  }
  vxm_free(state->context, faces);
  return status;
}
