/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/geometry.h"
#include "mesh/sort.h"
#include "repair/state/merge_rule.h"
#include "repair/state/repair_state.h"

#include <stdlib.h>
#include <string.h>

/** Of the diagonal: edges of unions that are shorter are collapsed, where it was tried in vain without. */
static const double SHORT = 0x1p-22;
/** The same where ends are one as 32-bit floats: far from the origin these are too coarse to go by. */
static const double SHORT_FLOAT = 0x1p-20;

/** Collapses leave short edges beside them, which the next round takes. */
enum { ROUNDS = 6 };

typedef struct short_edge {
  uint32_t from, to;
  double length;
} short_edge;

typedef struct collapsing {
  vxm_repair_state *state;
  vxm_soup *soup;
  size_t *begin;   /**< per vertex, and one more: where its faces begin */
  uint32_t *faces; /**< by vertex */
  uint8_t *locked; /**< per vertex: its faces change in this round */
  uint32_t *map;   /**< per vertex: the one that takes its place */
  short_edge *edges;
  size_t count;
  double scale; /**< of the frame in which areas are computed */
} collapsing;

static const uint32_t *corners_of(const collapsing *c, uint32_t face) {
  return c->soup->indices + c->soup->offsets[face];
}

static bool has_corner(const uint32_t *corner, uint32_t v) {
  return corner[0] == v || corner[1] == v || corner[2] == v;
}

/** The faces of triangles at each vertex; false if there are polygons. */
static bool list_faces(collapsing *c) {
  const vxm_soup *soup = c->soup;
  memset(c->begin, 0, (soup->vertex_count + 1) * sizeof *c->begin);
  for (size_t f = 0; f < soup->face_count; f++)
    if (soup->offsets[f + 1] - soup->offsets[f] != 3)
      return false;
  for (size_t i = 0; i < soup->corner_count; i++)
    c->begin[soup->indices[i] + 1]++;
  for (size_t v = 0; v < soup->vertex_count; v++)
    c->begin[v + 1] += c->begin[v];
  for (size_t i = soup->corner_count; i-- > 0;)
    c->faces[--c->begin[soup->indices[i] + 1]] = (uint32_t)(i / 3);
  for (size_t v = 0; v < soup->vertex_count; v++) /* each begin was moved down to where its faces begin */
    c->begin[v] = c->begin[v + 1];
  c->begin[soup->vertex_count] = soup->corner_count;
  return true;
}

static int by_length(const void *a, const void *b) {
  const short_edge *p = a, *q = b;
  if (p->length != q->length)
    return p->length < q->length ? -1 : 1;
  return vxm_compare_pairs(p->from, p->to, q->from, q->to);
}

/** Whether the ends are one vertex to programs that hold 32-bit floats. */
static bool is_float_point(const collapsing *c, const vxm_edge *edge) {
  const double *a = vxm_position(c->soup, edge->a), *b = vxm_position(c->soup, edge->b);
  if (c->state->union_try.doubles_only)
    return false;
  for (int i = 0; i < 3; i++)
    if (vxm_merge_coordinate(a[i], VXM_MERGE_FLOAT) != vxm_merge_coordinate(b[i], VXM_MERGE_FLOAT))
      return false;
  return true;
}

static void list_short(collapsing *c, double most, double most_float) {
  c->count = 0;
  for (size_t e = 0; e < c->state->edges.count; e++) {
    const vxm_edge *edge = &c->state->edges.edges[e];
    double length =
        vxm_vec3_length(vxm_vec3_between(vxm_position(c->soup, edge->a), vxm_position(c->soup, edge->b), 1));
    if (edge->count == 2 && (length < most || (length < most_float && is_float_point(c, edge))))
      c->edges[c->count++] = (short_edge){edge->b, edge->a, length};
  }
  qsort(c->edges, c->count, sizeof *c->edges, by_length);
}

/** Whether all vertices around one are free. */
static bool is_free(const collapsing *c, uint32_t v) {
  for (size_t i = c->begin[v]; i < c->begin[v + 1]; i++) {
    const uint32_t *corner = corners_of(c, c->faces[i]);
    if (c->locked[corner[0]] || c->locked[corner[1]] || c->locked[corner[2]])
      return false;
  }
  return true;
}

static void lock(collapsing *c, uint32_t v) {
  for (size_t i = c->begin[v]; i < c->begin[v + 1]; i++)
    for (int k = 0; k < 3; k++)
      c->locked[corners_of(c, c->faces[i])[k]] = 1;
}

static bool are_neighbours(const collapsing *c, uint32_t v, uint32_t w) {
  for (size_t i = c->begin[v]; i < c->begin[v + 1]; i++)
    if (has_corner(corners_of(c, c->faces[i]), w))
      return true;
  return false;
}

/** Whether the ends have no neighbours in common but those across the edge's two faces, and these have other
 * faces enough: then a manifold stays one (Dey et al. 1999, the link condition). */
static bool keeps_manifold(const collapsing *c, uint32_t from, uint32_t to) {
  int across = 0, common = 0;
  for (size_t i = c->begin[from]; i < c->begin[from + 1]; i++) {
    const uint32_t *corner = corners_of(c, c->faces[i]);
    bool shared = has_corner(corner, to);
    across += shared;
    for (int k = 0; k < 3; k++) {
      uint32_t v = corner[k];
      if (v == from || v == to)
        continue;
      common += are_neighbours(c, to, v);
      if (shared && c->begin[v + 1] - c->begin[v] < 4)
        return false;
    }
  }
  return across == 2 && common == 4; /* each neighbour is in two faces */
}

/** Whether no face that stays looks the other way after. */
static bool keeps_sides(const collapsing *c, uint32_t from, uint32_t to) {
  for (size_t i = c->begin[from]; i < c->begin[from + 1]; i++) {
    const uint32_t *corner = corners_of(c, c->faces[i]);
    if (has_corner(corner, to))
      continue;
    uint32_t moved[3];
    for (int k = 0; k < 3; k++)
      moved[k] = corner[k] == from ? to : corner[k];
    vxm_vec3 before = vxm_polygon_area(c->soup->positions, corner, 3, c->scale);
    vxm_vec3 after = vxm_polygon_area(c->soup->positions, moved, 3, c->scale);
    if (!(vxm_vec3_dot(before, after) > 0))
      return false;
  }
  return true;
}

static int64_t collapse_round(collapsing *c) {
  int64_t collapsed = 0;
  for (size_t v = 0; v < c->soup->vertex_count; v++)
    c->map[v] = (uint32_t)v;
  memset(c->locked, 0, c->soup->vertex_count);
  for (size_t i = 0; i < c->count; i++)
    for (int turn = 0; turn < 2; turn++) {
      uint32_t from = turn ? c->edges[i].to : c->edges[i].from, to = turn ? c->edges[i].from : c->edges[i].to;
      if (!is_free(c, from) || !is_free(c, to) || !keeps_manifold(c, from, to) || !keeps_sides(c, from, to))
        continue;
      lock(c, from);
      lock(c, to);
      c->map[from] = to;
      collapsed++;
      break;
    }
  return collapsed;
}

/** Puts the vertices in each other's place, and takes out the faces that go. */
static vxm_status apply(collapsing *c, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint8_t *remove = vxm_repair_state_scratch(c->state, c->soup->face_count, 1, &status, error);
  if (!remove)
    return status;
  vxm_repair_state_merge(c->state, c->map);
  for (size_t f = 0; f < c->soup->face_count; f++)
    remove[f] = !vxm_face_has_three(corners_of(c, (uint32_t)f), 3, NULL);
  vxm_repair_state_remove_faces(c->state, remove);
  vxm_repair_state_touch(c->state);
  vxm_free(c->state->context, remove);
  return VXM_OK;
}

static vxm_status collapse(collapsing *c, double diagonal, int64_t *total, vxm_error *error) {
  const double most = c->state->union_try.collapses ? SHORT * diagonal : 0,
               most_float = SHORT_FLOAT * diagonal;
  vxm_status status = VXM_OK;
  *total = 0;
  for (int round = 0; round < ROUNDS && status == VXM_OK; round++) {
    status = vxm_check_cancelled(c->state->context, error);
    if (status == VXM_OK)
      status = vxm_repair_state_edges(c->state, error);
    if (status != VXM_OK || !list_faces(c))
      return status;
    list_short(c, most, most_float);
    int64_t collapsed = c->count > 0 ? collapse_round(c) : 0;
    if (collapsed == 0)
      return VXM_OK;
    *total += collapsed;
    status = apply(c, error);
  }
  return status;
}

/** Collapses the shortest edges of a union, between points that the cutting has put beside each other: they
 * would be one vertex in other programs, and slivers are in the way of parting what touches. */
vxm_status vxm_pass_short_edges(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (state->counts[VXM_PASS_UNION] == 0)
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_status status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  const vxm_soup *soup = state->soup;
  collapsing c = {.state = state, .soup = state->soup, .scale = vxm_unit_scale_of(extent.bounds).scale};
  int64_t collapsed = 0;
  c.begin = vxm_repair_state_scratch(state, soup->vertex_count + 1, sizeof *c.begin, &status, error);
  if (c.begin)
    c.faces = vxm_repair_state_scratch(state, soup->corner_count, sizeof *c.faces, &status, error);
  if (c.faces)
    c.locked = vxm_repair_state_scratch(state, soup->vertex_count, 1, &status, error);
  if (c.locked)
    c.map = vxm_repair_state_scratch(state, soup->vertex_count, sizeof *c.map, &status, error);
  if (c.map)
    c.edges = vxm_repair_state_scratch(state, state->edges.count, sizeof *c.edges, &status, error);
  if (c.edges)
    status = collapse(&c, vxm_extent_diagonal(extent.bounds), &collapsed, error);
  vxm_free(state->context, c.edges);
  vxm_free(state->context, c.map);
  vxm_free(state->context, c.locked);
  vxm_free(state->context, c.faces);
  vxm_free(state->context, c.begin);
  *changed = collapsed > 0;
  return status;
}
