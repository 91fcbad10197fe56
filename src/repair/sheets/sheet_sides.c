/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/sheets/sheet_sides.h"

#include "repair/manifold/radial_sort.h"

enum { FACES_MAX = 1 << 29 };

typedef struct sorting {
  vxm_sheet_sides *out;
  vxm_edges edges;
  size_t *begin;          /**< per edge, and one more: where its sides begin */
  vxm_radial_side *sides; /**< by edge */
  double scale;
} sorting;

static size_t edge_at(const sorting *s, uint32_t corner) {
  const uint32_t *index = s->out->soup->indices;
  return vxm_edges_find(&s->edges, index[corner], index[corner % 3 == 2 ? corner - 2 : corner + 1]);
}

/** Lists the faces at each edge. */
static vxm_status list_sides(sorting *s, vxm_error *error) {
  const vxm_soup *soup = s->out->soup;
  vxm_status status = VXM_OK;
  for (size_t e = 0; e < s->edges.count; e++)
    s->begin[e + 1] = s->begin[e] + s->edges.edges[e].count;
  for (size_t c = soup->corner_count; c-- > 0 && status == VXM_OK;) {
    size_t e = edge_at(s, (uint32_t)c);
    vxm_radial_side *side = &s->sides[s->begin[e] + --s->edges.edges[e].count];
    *side = (vxm_radial_side){
        .side = (uint32_t)c, .face = (uint32_t)(c / 3), .forward = soup->indices[c] == s->edges.edges[e].a};
    status = vxm_check_cancelled_at(c, soup->context, error);
  }
  return status;
}

/** Each face sees the next one around the edge with the side that looks the way of growing angles: of one
 * that runs along the edge that is its front. */
static void see_next(sorting *s, size_t e) {
  const vxm_edge *edge = &s->edges.edges[e];
  const vxm_soup *soup = s->out->soup;
  vxm_radial_side *sides = s->sides + s->begin[e];
  size_t count = s->begin[e + 1] - s->begin[e];
  vxm_radial_sort_order(sides, count, soup, vxm_position(soup, edge->a), vxm_position(soup, edge->b),
                        s->scale);
  for (size_t i = 0; i < count; i++) {
    const vxm_radial_side *face = &sides[i], *next = &sides[(i + 1) % count];
    uint32_t seeing = 2 * face->side + !face->forward, seen = 2 * next->side + next->forward;
    s->out->across[seeing] = seen;
    s->out->across[seen] = seeing;
  }
}

vxm_status vxm_sheet_sides_build(vxm_sheet_sides *out, const vxm_soup *soup, double scale, vxm_error *error) {
  *out = (vxm_sheet_sides){.soup = soup, .count = 6 * soup->face_count};
  if (soup->face_count > FACES_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "sheets of more than %d triangles", FACES_MAX);
  sorting s = {.out = out, .scale = scale};
  vxm_status status = vxm_edges_build(&s.edges, soup->context, soup, NULL, error);
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  out->across = vxm_calloc(soup->context, out->count, sizeof *out->across, &local);
  out->cut = out->across ? vxm_calloc(soup->context, out->count, 1, &local) : NULL;
  s.begin = out->cut ? vxm_calloc(soup->context, s.edges.count + 1, sizeof *s.begin, &local) : NULL;
  s.sides = s.begin ? vxm_calloc(soup->context, soup->corner_count, sizeof *s.sides, &local) : NULL;
  if (s.sides)
    list_sides(&s, &local);
  for (size_t e = 0; e < s.edges.count && local.code == VXM_OK; e++)
    if (vxm_check_cancelled_at(e, soup->context, &local) == VXM_OK)
      see_next(&s, e);
  vxm_free(soup->context, s.sides);
  vxm_free(soup->context, s.begin);
  vxm_edges_destroy(&s.edges);
  if (local.code != VXM_OK) {
    vxm_sheet_sides_destroy(out);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_sheet_sides_destroy(vxm_sheet_sides *sides) {
  vxm_free(sides->soup->context, sides->cut);
  vxm_free(sides->soup->context, sides->across);
  sides->cut = NULL;
  sides->across = NULL;
}

bool vxm_sheet_step(const vxm_sheet_sides *sides, uint32_t *corner, uint32_t *edge) {
  uint32_t vertex = vxm_sheet_vertex(sides, *corner), seen = sides->across[*edge];
  if (vxm_sheet_is_rim(sides, *edge) || sides->cut[*edge] >> vxm_sheet_end(sides, *edge, vertex) & 1)
    return false;
  *corner = vxm_sheet_end(sides, seen, vertex) == 0 ? seen : vxm_sheet_next(seen);
  *edge = vxm_sheet_other_edge(*corner, seen);
  return true;
}

uint32_t vxm_sheet_walk_begin(const vxm_sheet_sides *sides, uint32_t corner, uint32_t *edge) {
  uint32_t at = corner, back = vxm_sheet_previous(corner);
  while (vxm_sheet_step(sides, &at, &back))
    if (at == corner)
      break;
  *edge = vxm_sheet_other_edge(at, back);
  return at;
}

void vxm_sheet_cut(vxm_sheet_sides *sides, uint32_t edge, uint32_t vertex) {
  uint32_t seen = sides->across[edge];
  sides->cut[edge] |= (uint8_t)(1 << vxm_sheet_end(sides, edge, vertex));
  sides->cut[seen] |= (uint8_t)(1 << vxm_sheet_end(sides, seen, vertex));
}
