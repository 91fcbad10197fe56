/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/halfedges.h"

enum { SCAN_MAX = 16 }; /**< edges of a vertex that are scanned; more are searched */

/** Place of the edge from `low` to `high`, which lies between begin and end. */
static size_t find_between(const vxm_edges *edges, size_t begin, size_t end, uint32_t high) {
  while (end - begin > SCAN_MAX) {
    size_t middle = begin + (end - begin) / 2;
    if (edges->edges[middle].b <= high)
      begin = middle;
    else
      end = middle;
  }
  for (size_t e = begin; e < end; e++)
    if (edges->edges[e].b == high)
      return e;
  return VXM_NO_EDGE;
}

static vxm_status fill(size_t *sides, const vxm_repair_state *state, const size_t *begin, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    vxm_status status = vxm_ask_at(f, state->context, error);
    if (status != VXM_OK)
      return status;
    bool counts = vxm_face_has_three(corner, count, NULL);
    for (size_t c = 0; c < count; c++) {
      uint32_t a = corner[c], b = corner[c + 1 < count ? c + 1 : 0], low = a < b ? a : b;
      sides[soup->offsets[f] + c] =
          counts && a != b ? find_between(&state->edges, begin[low], begin[low + 1], a < b ? b : a)
                           : VXM_NO_EDGE;
    }
  }
  return VXM_OK;
}

vxm_status vxm_halfedges_find(size_t **sides, vxm_repair_state *state, vxm_error *error) {
  *sides = NULL;
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  size_t vertices = state->soup->vertex_count;
  size_t *begin = vxm_repair_state_scratch(state, vertices + 1, sizeof *begin, &status, error);
  if (begin)
    *sides = vxm_repair_state_scratch(state, state->soup->corner_count, sizeof **sides, &status, error);
  if (*sides) {
    for (size_t e = 0; e < state->edges.count; e++)
      begin[state->edges.edges[e].a + 1]++;
    for (size_t v = 0; v < vertices; v++)
      begin[v + 1] += begin[v];
    status = fill(*sides, state, begin, error);
  }
  vxm_free(state->context, begin);
  if (status != VXM_OK) {
    vxm_free(state->context, *sides);
    *sides = NULL;
  }
  return status;
}
