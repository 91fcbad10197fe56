/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/group_rims.h"

#include "mesh/sort.h"

#include <stdlib.h>

static int by_vertex_then_group(const void *a, const void *b) {
  const vxm_rim_vertex *s = a, *t = b;
  return vxm_compare_pairs(s->vertex, s->group, t->vertex, t->group);
}

static bool is_rim(const vxm_edge_groups *groups, const vxm_edge *edges, uint64_t corner) {
  return groups->sides[corner] != VXM_NO_EDGE && vxm_edge_is_odd(&edges[groups->sides[corner]]);
}

vxm_status vxm_group_rims_find(vxm_group_rims *out, const vxm_edge_groups *groups, vxm_repair_state *state,
                               vxm_error *error) {
  const vxm_soup *soup = state->soup;
  const vxm_edge *edges = state->edges.edges;
  vxm_status status = VXM_OK;
  size_t count = 0;
  for (size_t c = 0; c < soup->corner_count; c++)
    count += is_rim(groups, edges, c);
  *out = (vxm_group_rims){.groups = groups};
  out->vertices = vxm_repair_state_scratch(state, 2 * count, sizeof *out->vertices, &status, error);
  if (!out->vertices)
    return status;
  for (size_t f = 0; count > 0 && f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
      if (is_rim(groups, edges, c)) {
        const vxm_edge *edge = &edges[groups->sides[c]];
        out->vertices[out->count++] = (vxm_rim_vertex){groups->of_face[f], edge->a};
        out->vertices[out->count++] = (vxm_rim_vertex){groups->of_face[f], edge->b};
      }
  qsort(out->vertices, out->count, sizeof *out->vertices, by_vertex_then_group);
  return VXM_OK;
}

void vxm_group_rims_destroy(vxm_group_rims *rims, vxm_context *context) {
  vxm_free(context, rims->vertices);
}

bool vxm_group_is_open_at(const vxm_group_rims *rims, size_t group, uint32_t vertex) {
  vxm_rim_vertex wanted = {group, vertex};
  return !rims->groups->groups[group].closed &&
         bsearch(&wanted, rims->vertices, rims->count, sizeof *rims->vertices, by_vertex_then_group);
}
