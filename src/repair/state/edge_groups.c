/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/edge_groups.h"

/** Joins the faces along every edge; `first` is scratch per edge: 1 + a face there. */
static vxm_status join_faces(const vxm_edge_groups *g, const vxm_soup *soup, size_t *first,
                             vxm_error *error) {
  for (size_t f = 0; f < soup->face_count; f++)
    g->of_face[f] = f;
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_status status = vxm_check_cancelled_at(f, soup->context, error);
    if (status != VXM_OK)
      return status;
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      if (g->sides[c] == VXM_NO_EDGE)
        continue;
      size_t *other = &first[g->sides[c]];
      if (*other == 0)
        *other = f + 1;
      else
        vxm_set_unite(g->of_face, f, *other - 1);
    }
  }
  return VXM_OK;
}

/** Numbers the sets in the order of their first faces; `number` is scratch per face. */
static void number_groups(vxm_edge_groups *g, size_t faces, size_t *number) {
  for (size_t f = 0; f < faces; f++)
    number[f] = SIZE_MAX;
  for (size_t f = 0; f < faces; f++) {
    size_t root = vxm_set_of(g->of_face, f);
    if (number[root] == SIZE_MAX)
      number[root] = g->count++;
  }
  for (size_t f = 0; f < faces; f++)
    g->of_face[f] = vxm_set_of(g->of_face, f);
  for (size_t f = 0; f < faces; f++)
    g->of_face[f] = number[g->of_face[f]];
}

static vxm_status look_at_edges(const vxm_edge_groups *g, const vxm_repair_state *state, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  for (size_t i = 0; i < g->count; i++)
    g->groups[i] = (vxm_edge_group){true, true, true};
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_status status = vxm_check_cancelled_at(f, soup->context, error);
    if (status != VXM_OK)
      return status;
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      if (g->sides[c] == VXM_NO_EDGE)
        continue;
      const vxm_edge *edge = &state->edges.edges[g->sides[c]];
      vxm_edge_group *group = &g->groups[g->of_face[f]];
      group->closed = group->closed && edge->count % 2 == 0;
      group->balanced = group->balanced && 2 * (uint64_t)edge->forward == edge->count;
      group->manifold = group->manifold && edge->count <= 2;
    }
  }
  return VXM_OK;
}

vxm_status vxm_edge_groups_find(vxm_edge_groups *out, vxm_repair_state *state, vxm_error *error) {
  *out = (vxm_edge_groups){0};
  size_t faces = state->soup->face_count;
  size_t *scratch = NULL;
  vxm_status status = vxm_repair_state_edges(state, error);
  out->sides = state->edges.sides;
  if (status == VXM_OK)
    out->of_face = vxm_repair_state_scratch(state, faces, sizeof *out->of_face, &status, error);
  if (status == VXM_OK)
    scratch = vxm_repair_state_scratch(state, state->edges.count > faces ? state->edges.count : faces,
                                       sizeof *scratch, &status, error);
  if (status == VXM_OK)
    status = join_faces(out, state->soup, scratch, error);
  if (status == VXM_OK) {
    number_groups(out, faces, scratch);
    out->groups = vxm_repair_state_scratch(state, out->count, sizeof *out->groups, &status, error);
  }
  vxm_free(state->context, scratch);
  if (status == VXM_OK)
    status = look_at_edges(out, state, error);
  return status;
}

void vxm_edge_groups_list(const vxm_edge_groups *groups, size_t face_count, const uint8_t *chosen,
                          size_t *begin, size_t *faces) {
  for (size_t f = 0; f < face_count; f++)
    begin[groups->of_face[f]] += chosen[f];
  for (size_t g = 0; g < groups->count; g++)
    begin[g + 1] += begin[g]; /* where those of each end, so far */
  for (size_t f = face_count; f-- > 0;)
    if (chosen[f])
      faces[--begin[groups->of_face[f]]] = f;
}

void vxm_edge_groups_destroy(vxm_edge_groups *groups, vxm_context *context) {
  vxm_free(context, groups->groups);
  vxm_free(context, groups->of_face);
  *groups = (vxm_edge_groups){0};
}
