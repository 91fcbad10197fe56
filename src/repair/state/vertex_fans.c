/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/vertex_fans.h"

#include "mesh/disjoint_sets.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/** Joins at both ends of every edge the corners of the faces along it. */
static vxm_status join_corners(const vxm_soup *soup, const uint32_t *sides, uint32_t (*first)[2],
                               uint32_t *parent, vxm_error *error) {
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_status status = vxm_check_cancelled_at(f, soup->context, error);
    if (status != VXM_OK)
      return status;
    size_t count, begin = (size_t)soup->offsets[f];
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      size_t next = i + 1 < count ? i + 1 : 0, edge = sides[begin + i];
      if (edge == VXM_NO_EDGE)
        continue;
      bool downward = corner[i] > corner[next];
      uint32_t *here = &first[edge][downward], *there = &first[edge][!downward];
      *here = *here == NONE ? (uint32_t)(begin + i) : *here;
      *there = *there == NONE ? (uint32_t)(begin + next) : *there;
      vxm_set_unite_in_order(parent, *here, (uint32_t)(begin + i));
      vxm_set_unite_in_order(parent, *there, (uint32_t)(begin + next));
    }
  }
  return VXM_OK;
}

/** Fills `fans`, which are zero. */
static vxm_status count_fans(uint8_t *fans, const vxm_repair_state *state, uint32_t (*first)[2],
                             uint32_t *parent, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  memset(first, 0xff, state->edges.count * sizeof *first); /* NONE */
  for (size_t c = 0; c < soup->corner_count; c++)
    parent[c] = (uint32_t)c;
  vxm_status status = join_corners(soup, state->edges.sides, first, parent, error);
  for (size_t c = 0; c < soup->corner_count && status == VXM_OK; c++)
    if (parent[c] == c && fans[soup->indices[c]] < UINT8_MAX)
      fans[soup->indices[c]]++;
  return status;
}

vxm_status vxm_vertex_fans_count(uint8_t **fans, vxm_repair_state *state, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  vxm_context *context = state->context;
  vxm_error local = VXM_ERROR_INIT;
  *fans = NULL;
  if (soup->corner_count >= NONE)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu corners are too many to number; split the mesh",
                    soup->corner_count);
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  uint32_t *parent = vxm_alloc(context, soup->corner_count, sizeof *parent, &local);
  uint32_t(*first)[2] = parent ? vxm_alloc(context, state->edges.count, sizeof *first, &local) : NULL;
  *fans = first ? vxm_calloc(context, soup->vertex_count, 1, &local) : NULL;
  status = *fans ? count_fans(*fans, state, first, parent, &local) : local.code;
  vxm_free(context, first);
  vxm_free(context, parent);
  if (status != VXM_OK) {
    vxm_free(context, *fans);
    *fans = NULL;
    vxm_error_pass(error, &local);
  }
  return status;
}

/* ---- Where it is known what lies across each side ---- */

/** A corner, and the face it is of. */
typedef struct place {
  uint64_t corner;
  size_t face;
} place;

/** The corner at the same vertex of the face across the side that begins at a corner: where the side that
 * runs back ends. */
static inline place step(const vxm_soup *soup, const uint32_t *adjacent, place at) {
  const uint32_t *index = soup->indices;
  uint64_t after = at.corner + 1 < soup->offsets[at.face + 1] ? at.corner + 1 : soup->offsets[at.face];
  uint32_t here = index[at.corner], there = index[after];
  place next = {.face = adjacent[at.corner]};
  uint64_t begin = soup->offsets[next.face], end = soup->offsets[next.face + 1], last = end - 1;
  next.corner = begin;
  for (uint64_t c = begin; c < end; last = c++) /* to the end: nobody can tell which it is */
    next.corner = ((index[c] == here) & (index[last] == there)) ? c : next.corner;
  return next;
}

/** Whether a walk about a vertex comes back after so many corners, and not before. */
static bool goes_round(const vxm_soup *soup, const uint32_t *adjacent, place first, uint32_t corners) {
  place at = first;
  for (uint32_t count = 1; count <= corners; count++) {
    at = step(soup, adjacent, at);
    if (at.corner == first.corner)
      return count == corners;
  }
  return false;
}

/** Whether a walk about each vertex from its first corner meets all its corners, in a closed soup. */
static vxm_status are_whole(bool *out, const vxm_soup *soup, const uint32_t *adjacent, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = VXM_OK;
  uint32_t *corners = vxm_calloc(soup->context, soup->vertex_count, sizeof *corners, &local);
  *out = corners != NULL;
  for (size_t c = 0; corners && c < soup->corner_count; c++)
    corners[soup->indices[c]]++;
  for (size_t f = 0; *out && f < soup->face_count && status == VXM_OK; f++) {
    for (uint64_t c = soup->offsets[f]; *out && c < soup->offsets[f + 1]; c++) {
      uint32_t *left = &corners[soup->indices[c]];
      *out = *left == 0 || goes_round(soup, adjacent, (place){c, f}, *left);
      *left = 0; /* it was looked at */
    }
    status = vxm_check_cancelled_at(f, soup->context, &local);
  }
  vxm_free(soup->context, corners);
  status = corners ? status : local.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Whether steps, which go through all of a face, take no more than some corners each in the mean. */
static bool are_small(const vxm_soup *soup) {
  const double most = 8;
  double steps = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    double count = (double)(soup->offsets[f + 1] - soup->offsets[f]);
    steps += count * count;
  }
  return steps <= most * (double)soup->corner_count;
}

/* ---- All together ---- */

vxm_status vxm_is_manifold(bool *out, vxm_repair_state *state, vxm_error *error) {
  *out = state->is_manifold;
  if (*out)
    return VXM_OK;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.crowded > 0 || state->edges.against > 0)
    return status;
  /* where each corner has a side, as there is none from a vertex to itself */
  if (state->edges.adjacent && 2 * state->edges.count == state->soup->corner_count && are_small(state->soup))
    status = are_whole(out, state->soup, state->edges.adjacent, error);
  else {
    uint8_t *fans;
    status = vxm_vertex_fans_count(&fans, state, error);
    *out = status == VXM_OK;
    for (size_t v = 0; *out && v < state->soup->vertex_count; v++)
      *out = fans[v] <= 1;
    vxm_free(state->context, fans);
  }
  *out = *out && status == VXM_OK;
  state->is_manifold = *out;
  return status;
}
