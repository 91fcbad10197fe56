/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/vertex_fans.h"

/** The corner that stands for the fan of this one. Paths are halved on the way. */
static size_t root_of(size_t *parent, size_t corner) {
  while (parent[corner] != corner) {
    parent[corner] = parent[parent[corner]];
    corner = parent[corner];
  }
  return corner;
}

static void join(size_t *parent, size_t a, size_t b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

/** Joins at both ends of every edge the corners of the faces along it. */
static vxm_status join_corners(const vxm_soup *soup, const uint32_t *sides, size_t (*first)[2],
                               size_t *parent, vxm_error *error) {
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
      bool upward = corner[i] < corner[next];
      size_t at[2] = {begin + (upward ? i : next),
                      begin + (upward ? next : i)}; /* at its lower and upper end */
      for (int end = 0; end < 2; end++) {
        if (first[edge][end] == 0)
          first[edge][end] = at[end] + 1;
        join(parent, first[edge][end] - 1, at[end]);
      }
    }
  }
  return VXM_OK;
}

vxm_status vxm_vertex_fans_count(uint8_t **fans, vxm_repair_state *state, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  size_t *parent = NULL, (*first)[2] = NULL;
  *fans = NULL;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status == VXM_OK)
    parent = vxm_repair_state_scratch(state, soup->corner_count, sizeof *parent, &status, error);
  if (status == VXM_OK)
    first = vxm_repair_state_scratch(state, state->edges.count, sizeof *first, &status, error);
  if (status == VXM_OK)
    *fans = vxm_repair_state_scratch(state, soup->vertex_count, 1, &status, error);
  if (status == VXM_OK) {
    for (size_t c = 0; c < soup->corner_count && status == VXM_OK; c++) {
      parent[c] = c;
      status = vxm_ask_at(c, state->context, error);
    }
    if (status == VXM_OK)
      status = join_corners(soup, state->edges.sides, first, parent, error);
    for (size_t c = 0; c < soup->corner_count && status == VXM_OK; c++)
      if (parent[c] == c && (*fans)[soup->indices[c]] < UINT8_MAX)
        (*fans)[soup->indices[c]]++;
  }
  vxm_free(state->context, first);
  vxm_free(state->context, parent);
  if (status != VXM_OK) {
    vxm_free(state->context, *fans);
    *fans = NULL;
  }
  return status;
}

vxm_status vxm_is_manifold(bool *out, vxm_repair_state *state, vxm_error *error) {
  *out = false;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  for (size_t e = 0; e < state->edges.count; e++) {
    const vxm_edge *edge = &state->edges.edges[e];
    if (edge->count > 2 || (edge->count == 2 && edge->forward != 1))
      return VXM_OK;
  }
  uint8_t *fans;
  status = vxm_vertex_fans_count(&fans, state, error);
  *out = status == VXM_OK;
  for (size_t v = 0; *out && v < state->soup->vertex_count; v++)
    *out = fans[v] <= 1;
  vxm_free(state->context, fans);
  return status;
}
