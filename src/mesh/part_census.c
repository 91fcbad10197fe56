/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/part_census.h"

#include "mesh/boundary_loops.h"
#include "mesh/edges.h"
#include "mesh/geometry.h"
#include "mesh/nonfinite.h"
#include "mesh/quad_diagonal.h"
#include "mesh/weld.h"

#include <math.h>
#include <string.h>

static const uint32_t NO_PART = UINT32_MAX;

typedef struct measuring {
  vxm_part_state *states;
  vxm_soup view; /**< the soup with welded corners */
  const uint32_t *face_parts;
  uint32_t *vertex_part; /**< per vertex: the first part with a face there */
  bool shared;           /**< some vertex has faces of several parts */
  uint32_t *edge_part;   /**< per edge: the first part with a face there; NULL = that of its vertices */
  vxm_error error;
} measuring;

static void add_face(measuring *m, const vxm_unit_scale *frame, size_t face) {
  vxm_part_state *state = &m->states[m->face_parts[face]];
  size_t count;
  const uint32_t *corner = vxm_face(&m->view, face, &count);
  bool first = state->faces++ == 0;
  for (size_t i = 0; i < count; i++) {
    const double *p = vxm_position(&m->view, corner[i]);
    uint32_t *part = &m->vertex_part[corner[i]];
    m->shared = m->shared || (*part != NO_PART && *part != m->face_parts[face]);
    *part = *part > m->face_parts[face] ? m->face_parts[face] : *part;
    if (!vxm_is_finite(p))
      continue;
    for (int a = 0; a < 3; a++) {
      state->bounds[a] = first ? p[a] : fmin(state->bounds[a], p[a]);
      state->bounds[a + 3] = first ? p[a] : fmax(state->bounds[a + 3], p[a]);
    }
    first = false;
  }
  if (count == 0)
    return;
  vxm_vec3 normal = vxm_polygon_area(m->view.positions, corner, count, frame->scale);
  const double *apex = vxm_position(&m->view, corner[vxm_polygon_apex(m->view.positions, corner, count)]);
  vxm_vec3 from = vxm_vec3_between(apex, frame->centre, frame->scale);
  double area = vxm_vec3_length(normal), volume = vxm_polygon_cone(from, normal);
  if (isfinite(area) && isfinite(volume)) {
    state->area += area;
    state->volume += volume;
  }
}

/** Where parts share vertices, asks the faces which part an edge is of. */
static vxm_status find_edge_parts(measuring *m, const vxm_edges *edges) {
  if (!m->shared)
    return VXM_OK;
  m->edge_part = vxm_alloc(m->view.context, edges->count, sizeof *m->edge_part, &m->error);
  if (!m->edge_part)
    return m->error.code;
  for (size_t e = 0; e < edges->count; e++)
    m->edge_part[e] = NO_PART;
  for (size_t f = 0; f < m->view.face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(&m->view, f, &count);
    if (vxm_check_cancelled_at(f, m->view.context, &m->error) != VXM_OK)
      return m->error.code;
    if (!vxm_face_has_three(corner, count, NULL))
      continue;
    for (size_t i = 0; i < count; i++) {
      uint32_t next = corner[i + 1 < count ? i + 1 : 0];
      if (next == corner[i])
        continue;
      uint32_t *part = &m->edge_part[vxm_edges_find(edges, corner[i], next)];
      *part = *part > m->face_parts[f] ? m->face_parts[f] : *part;
    }
  }
  return VXM_OK;
}

static uint32_t part_of(const measuring *m, const vxm_edges *edges, size_t edge) {
  return m->edge_part ? m->edge_part[edge] : m->vertex_part[edges->edges[edge].a];
}

static void add_edges(measuring *m, const vxm_edges *edges) {
  for (size_t e = 0; e < edges->count; e++) {
    const vxm_edge *edge = &edges->edges[e];
    vxm_part_state *state = &m->states[part_of(m, edges, e)];
    state->boundary_edges += edge->count == 1;
    state->nonmanifold_edges += edge->count > 2;
    state->inconsistent_edges += edge->count == 2 && edge->forward != 1;
    state->closed = state->closed && !vxm_edge_is_odd(edge);
  }
}

static vxm_status measure(measuring *m, size_t part_count) {
  vxm_extent extent;
  if (vxm_extent_find(&extent, m->view.context, &m->view, &m->error) != VXM_OK)
    return m->error.code;
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  memset(m->states, 0, part_count * sizeof *m->states);
  for (size_t p = 0; p < part_count; p++) {
    m->states[p].size = sizeof *m->states;
    m->states[p].self_intersections = -1; /* which src/repair counts */
  }
  for (size_t v = 0; v < m->view.vertex_count; v++)
    m->vertex_part[v] = NO_PART;
  for (size_t f = 0; f < m->view.face_count; f++) {
    if (vxm_check_cancelled_at(f, m->view.context, &m->error) != VXM_OK)
      return m->error.code;
    add_face(m, &frame, f);
  }
  for (size_t i = 0; i < part_count; i++) {
    vxm_part_state *state = &m->states[i];
    state->closed = state->faces > 0;
    /* only now: what is beyond the range of doubles becomes infinite, and cancels nothing */
    state->area = state->area / frame.scale / frame.scale;
    state->volume = state->volume / frame.scale / frame.scale / frame.scale;
  }
  vxm_edges edges;
  vxm_boundary_loops loops;
  vxm_status status = vxm_edges_build(&edges, m->view.context, &m->view, NULL, &m->error);
  if (status != VXM_OK)
    return status;
  loops = (vxm_boundary_loops){0};
  status = find_edge_parts(m, &edges);
  if (status == VXM_OK) {
    add_edges(m, &edges);
    status = vxm_boundary_loops_build(&loops, &m->view, &edges, &m->error);
  }
  for (size_t l = 0; status == VXM_OK && l < loops.count; l++)
    m->states[part_of(m, &edges, loops.edge[loops.begin[l]])].holes++;
  if (loops.context)
    vxm_boundary_loops_destroy(&loops);
  vxm_edges_destroy(&edges);
  return status;
}

vxm_status vxm_part_census_all(vxm_part_state *out, size_t part_count, const vxm_soup *soup,
                               const uint32_t *face_parts, vxm_error *error) {
  measuring m = {.states = out, .view = *soup, .face_parts = face_parts, .error = VXM_ERROR_INIT};
  vxm_context *context = soup->context;
  uint32_t *map = vxm_alloc(context, soup->vertex_count, sizeof *map, &m.error);
  m.view.indices = map ? vxm_alloc(context, soup->corner_count, sizeof *m.view.indices, &m.error) : NULL;
  m.vertex_part =
      m.view.indices ? vxm_alloc(context, soup->vertex_count, sizeof *m.vertex_part, &m.error) : NULL;
  vxm_status status = m.vertex_part
                          ? vxm_weld_exact(context, soup->positions, soup->vertex_count, map, NULL, &m.error)
                          : m.error.code;
  if (status == VXM_OK) {
    for (size_t c = 0; c < soup->corner_count; c++)
      m.view.indices[c] = map[soup->indices[c]];
    vxm_nonfinite_collapse(m.view.indices, soup); /* as the census of the whole does */
    status = measure(&m, part_count);
  }
  vxm_free(context, m.edge_part);
  vxm_free(context, m.vertex_part);
  vxm_free(context, m.view.indices);
  vxm_free(context, map);
  if (status != VXM_OK)
    vxm_error_pass(error, &m.error);
  return status;
}
