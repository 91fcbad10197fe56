/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/triangulated_polygons.h"

#include "base/hash.h"
#include "mesh/disjoint_sets.h"

#define NONE SIZE_MAX

/** Cosine of the angle between triangles and their polygon: less than the first is no polygon, and less than
 * the other is not plane. */
static const double NEARLY_PLANE = 0.95, PLANE = 1 - 1e-10;

/** Whether a face may be of such a polygon: of few of a mesh all corners are at edges with more than two
 * sides, which is why that is asked first. `rim` tells it per vertex. */
static bool may_be_of_one(const vxm_repair_state *state, const uint8_t *rim, size_t face) {
  const vxm_soup *soup = state->soup;
  const vxm_edge *edges = state->edges.edges;
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count), *side = state->edges.sides + soup->offsets[face];
  if (count != 3 || !rim[corner[0]] || !rim[corner[1]] || !rim[corner[2]])
    return false;
  for (int i = 0; i < 3; i++)
    if (side[i] == VXM_NO_EDGE || edges[side[i]].count < 2 ||
        (edges[side[i]].count == 2 && edges[side[i]].forward != 1))
      return false;
  return true;
}

static vxm_status list_triangles(vxm_polygons *out, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_repair_state *state = out->state;
  const vxm_edge *edges = state->edges.edges;
  uint8_t *rim = vxm_repair_state_scratch(state, state->soup->vertex_count, sizeof *rim, &status, error);
  if (!rim)
    return status;
  for (size_t e = 0; e < state->edges.count; e++)
    if (edges[e].count > 2)
      rim[edges[e].a] = rim[edges[e].b] = 1;
  size_t capacity = 0;
  void *grown = NULL;
  for (size_t f = 0; f < state->soup->face_count && status == VXM_OK; f++) {
    if (!may_be_of_one(state, rim, f))
      continue;
    status =
        vxm_grow(state->context, &grown, &capacity, out->triangle_count + 1, sizeof *out->triangles, error);
    out->triangles = grown;
    if (status == VXM_OK)
      out->triangles[out->triangle_count++] = f;
  }
  vxm_free(state->context, rim);
  return status;
}

/** The edges of a triangle. */
static const uint32_t *sides_of(const vxm_polygons *p, size_t triangle) {
  return p->state->edges.sides + p->state->soup->offsets[p->triangles[triangle]];
}

/** Joins two triangles over each edge that has no more; `first` is scratch per edge. */
static vxm_status join_triangles(vxm_polygons *out, size_t *first, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < out->triangle_count; t++)
    out->parent[t] = t;
  for (size_t t = 0; t < out->triangle_count && status == VXM_OK; t++) {
    status = vxm_check_cancelled_at(t, out->state->context, error);
    for (size_t i = 3 * t; i < 3 * t + 3; i++) {
      uint32_t e = sides_of(out, t)[i % 3];
      out->across[i] = NONE;
      if (out->state->edges.edges[e].count != 2)
        continue;
      if (first[e] == 0) {
        first[e] = i + 1;
        continue;
      }
      size_t other = first[e] - 1;
      out->across[i] = other / 3;
      out->across[other] = t;
      vxm_set_unite(out->parent, t, other / 3);
    }
  }
  return status;
}

/** Adds up what the edges tell of the polygons. */
static void add_up(vxm_polygons *out) {
  const uint32_t *tags = out->state->soup->face_tags;
  for (size_t t = 0; t < out->triangle_count; t++) {
    size_t root = vxm_set_of(out->parent, t);
    const uint32_t *side = sides_of(out, t);
    vxm_triangulated *p = &out->polygons[root];
    p->triangles++;
    p->mixed |= tags && tags[out->triangles[t]] != tags[out->triangles[root]];
    for (size_t i = 0; i < 3; i++)
      if (out->across[3 * t + i] == NONE) {
        p->border++;
        p->hash += vxm_mix(side[i] + UINT64_C(1));
        p->rimmed |= out->state->edges.edges[side[i]].count <= 2;
      }
  }
}

vxm_status vxm_polygons_find(vxm_polygons *out, vxm_repair_state *state, vxm_error *error) {
  *out = (vxm_polygons){.state = state};
  vxm_status status = list_triangles(out, error);
  size_t count = out->triangle_count, *first = NULL;
  if (status == VXM_OK && count < 4) /* for two of two triangles */
    return VXM_OK;
  if (status == VXM_OK)
    out->across = vxm_repair_state_scratch(state, 3 * count, sizeof *out->across, &status, error);
  if (out->across)
    out->parent = vxm_repair_state_scratch(state, count, sizeof *out->parent, &status, error);
  if (out->parent)
    out->polygons = vxm_repair_state_scratch(state, count, sizeof *out->polygons, &status, error);
  if (out->polygons)
    first = vxm_repair_state_scratch(state, state->edges.count, sizeof *first, &status, error);
  if (first)
    status = join_triangles(out, first, error);
  vxm_free(state->context, first);
  if (status == VXM_OK)
    add_up(out);
  return status;
}

void vxm_polygons_destroy(vxm_polygons *polygons) {
  vxm_context *context = polygons->state->context;
  vxm_free(context, polygons->polygons);
  vxm_free(context, polygons->parent);
  vxm_free(context, polygons->across);
  vxm_free(context, polygons->triangles);
}

/* ---- Planes ---- */

static vxm_vec3 area_of(const vxm_polygons *p, size_t triangle, double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(p->state->soup, p->triangles[triangle], &count);
  return vxm_polygon_area(p->state->soup->positions, corner, count, scale);
}

static bool points_along(vxm_vec3 area, vxm_vec3 other, double cosine) {
  double both = vxm_vec3_length(area) * vxm_vec3_length(other);
  return both > 0 && vxm_vec3_dot(area, other) >= cosine * both;
}

void vxm_polygons_measure(vxm_polygons *polygons, double scale) {
  const size_t *across = polygons->across;
  for (size_t t = 0; t < polygons->triangle_count; t++) {
    vxm_triangulated *p = &polygons->polygons[vxm_set_of(polygons->parent, t)];
    p->plane = true;
    p->area = vxm_vec3_sum(p->area, area_of(polygons, t, scale));
  }
  for (size_t t = 0; t < polygons->triangle_count; t++) {
    vxm_triangulated *p = &polygons->polygons[vxm_set_of(polygons->parent, t)];
    vxm_vec3 area = area_of(polygons, t, scale);
    p->bent = p->bent || !points_along(area, p->area, NEARLY_PLANE);
    p->plane = p->plane && points_along(area, p->area, PLANE);
    for (size_t i = 3 * t; i < 3 * t + 3; i++)
      p->bent = p->bent || (across[i] != NONE && across[i] < t &&
                            !points_along(area, area_of(polygons, across[i], scale), NEARLY_PLANE));
  }
}

bool vxm_polygons_may_be_one(const vxm_triangulated *p, const vxm_triangulated *q, int turn) {
  vxm_vec3 area = {turn * q->area.x, turn * q->area.y, turn * q->area.z};
  bool plane = p->plane && q->plane;
  return (plane || turn < 0) && points_along(p->area, area, plane ? PLANE : NEARLY_PLANE);
}
