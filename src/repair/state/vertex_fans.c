/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/vertex_fans.h"

#include "mesh/disjoint_sets.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/** Joins at both ends of every edge the corners of the faces along it. */
static vxm_status join_corners(const vxm_soup *soup, const uint32_t *sides, uint32_t (*first)[2],
                               uint32_t *parent, vxm_error *error) {
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_status status = vxm_ask_at(f, soup->context, error);
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
      vxm_sets_join(parent, *here, (uint32_t)(begin + i));
      vxm_sets_join(parent, *there, (uint32_t)(begin + next));
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

vxm_status vxm_is_manifold(bool *out, vxm_repair_state *state, vxm_error *error) {
  *out = state->is_manifold;
  if (*out)
    return VXM_OK;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK || state->edges.crowded > 0 || state->edges.against > 0)
    return status;
  uint8_t *fans;
  status = vxm_vertex_fans_count(&fans, state, error);
  *out = status == VXM_OK;
  for (size_t v = 0; *out && v < state->soup->vertex_count; v++)
    *out = fans[v] <= 1;
  vxm_free(state->context, fans);
  state->is_manifold = *out;
  return status;
}
