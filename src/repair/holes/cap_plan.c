/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/holes/cap_plan.h"

#include "mesh/geometry.h"
#include "repair/state/position_set.h"

#include <string.h>

void *vxm_cap_plan_allocate(vxm_cap_plan *p, size_t count, size_t size) {
  return vxm_calloc(p->state->context, count, size, &p->error);
}

/* ---- What is open ---- */

static bool find_edge_faces(vxm_cap_plan *p) {
  if (vxm_repair_state_edges(p->state, &p->error) != VXM_OK)
    return false;
  const uint32_t *sides = p->state->edges.sides;
  p->edge_face = vxm_cap_plan_allocate(p, p->state->edges.count, sizeof *p->edge_face);
  for (size_t f = p->soup->face_count; p->edge_face && f-- > 0;)
    for (uint64_t s = p->soup->offsets[f]; s < p->soup->offsets[f + 1]; s++)
      if (sides[s] != VXM_NO_EDGE)
        p->edge_face[sides[s]] = f;
  return p->edge_face != NULL;
}

static double scale_of(vxm_repair_state *state) {
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  return vxm_unit_scale_of(extent.bounds).scale;
}

bool vxm_cap_plan_begin(vxm_cap_plan *p, vxm_repair_state *state, size_t most) {
  *p = (vxm_cap_plan){.state = state, .soup = state->soup, .error = VXM_ERROR_INIT, .most = most};
  p->scale = scale_of(state);
  if (!find_edge_faces(p) || vxm_boundary_loops_build(&p->loops, p->soup, &state->edges, &p->error) != VXM_OK)
    return false;
  p->caps = (vxm_caps){.soup = p->soup, .edges = &state->edges, .scale = p->scale};
  p->triangles = vxm_cap_plan_allocate(p, p->loops.count + 1, sizeof *p->triangles);
  p->points = vxm_cap_plan_allocate(p, p->loops.count + 1, sizeof *p->points);
  p->wanted = vxm_cap_plan_allocate(p, p->loops.count, sizeof *p->wanted);
  return p->triangles && p->points && p->wanted;
}

vxm_status vxm_cap_plan_end(vxm_cap_plan *p, bool done, vxm_error *error) {
  vxm_context *context = p->state->context;
  if (p->caps.soup)
    vxm_caps_destroy(&p->caps);
  if (p->loops.context)
    vxm_boundary_loops_destroy(&p->loops);
  vxm_free(context, p->wanted);
  vxm_free(context, p->points);
  vxm_free(context, p->triangles);
  vxm_free(context, p->edge_face);
  if (!done)
    vxm_error_pass(error, &p->error);
  return done ? VXM_OK : p->error.code;
}

bool vxm_cap_plan_is_plain(const vxm_cap_plan *p, size_t loop) {
  size_t begin = p->loops.begin[loop], count = p->loops.begin[loop + 1] - begin, along = 0;
  for (size_t s = begin; s < begin + count; s++) {
    const vxm_edge *edge = &p->state->edges.edges[p->loops.edge[s]];
    if (edge->count != 1)
      return false;
    along += (edge->a == p->loops.vertex[s]) == (edge->forward == 1);
  }
  return along == 0 || along == count;
}

/* ---- Caps ---- */

static bool face_has(const vxm_soup *soup, size_t face, uint32_t vertex) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  for (size_t i = 0; i < count; i++)
    if (corner[i] == vertex)
      return true;
  return false;
}

/** Whether a triangle over a loop of three edges would not repeat a face. */
static bool is_plain(const vxm_cap_plan *p, size_t loop) {
  size_t begin = p->loops.begin[loop];
  if (p->loops.begin[loop + 1] - begin != 3)
    return true;
  const vxm_edge *edge = &p->state->edges.edges[p->loops.edge[begin]];
  size_t face = p->edge_face[p->loops.edge[begin]];
  size_t corners = (size_t)(p->soup->offsets[face + 1] - p->soup->offsets[face]);
  return edge->count == 1 && (corners != 3 || !face_has(p->soup, face, p->loops.vertex[begin + 2]));
}

bool vxm_cap_plan_add(vxm_cap_plan *p, size_t loop) {
  bool added = vxm_caps_add(&p->caps, &p->loops, loop, is_plain(p, loop), &p->error) == VXM_OK;
  vxm_cap_plan_pass(p, loop);
  return added;
}

bool vxm_cap_plan_take(vxm_cap_plan *p, const uint32_t (*triangles)[3], size_t count) {
  vxm_caps *caps = &p->caps;
  void *all = caps->triangles;
  if (vxm_grow(p->state->context, &all, &caps->triangle_capacity, caps->triangle_count + count,
               sizeof *caps->triangles, &p->error) != VXM_OK)
    return false;
  caps->triangles = all;
  memcpy(caps->triangles + caps->triangle_count, triangles, count * sizeof *triangles);
  caps->triangle_count += count;
  return true;
}

void vxm_cap_plan_pass(vxm_cap_plan *p, size_t loop) {
  p->triangles[loop + 1] = p->caps.triangle_count;
  p->points[loop + 1] = p->caps.point_count;
}

/* ---- New vertices: none may have the position of another one, or welding would merge them ---- */

/** Moves a taken position a little and a little more toward a vertex, until it is free. */
static void find_free(const vxm_repair_state *state, const vxm_position_set *taken, double p[3],
                      const double *toward) {
  double from[3] = {p[0], p[1], p[2]}, part = 0x1p-12;
  for (int tries = 0; tries < 64 && vxm_position_set_taken(taken, p); tries++, part *= 1.25)
    for (int a = 0; a < 3; a++)
      p[a] = vxm_repair_state_round(state, from[a] + part * (toward[a] - from[a]));
}

/* ---- Adding the caps ---- */

static bool make_room(vxm_cap_plan *p, size_t faces, size_t points) {
  vxm_soup *soup = p->soup;
  size_t total = soup->face_count + faces;
  if (vxm_soup_reserve(soup, soup->vertex_count + points, total, soup->corner_count + 3 * faces, &p->error) !=
      VXM_OK)
    return false;
  if (soup->face_tags) {
    uint32_t *tags = vxm_realloc(soup->context, soup->face_tags, total, sizeof *tags, &p->error);
    if (!tags)
      return false;
    soup->face_tags = tags;
  }
  if (soup->face_parts) {
    uint32_t *parts = vxm_realloc(soup->context, soup->face_parts, total, sizeof *parts, &p->error);
    if (!parts)
      return false;
    soup->face_parts = parts;
  }
  if (p->state->turned) {
    uint8_t *turned = vxm_realloc(soup->context, p->state->turned, total, sizeof *turned, &p->error);
    if (!turned)
      return false;
    memset(turned + soup->face_count, VXM_ADDED, faces);
    p->state->turned = turned;
  }
  return vxm_repair_state_grow_marks(p->state, soup->vertex_count, soup->vertex_count + points, &p->error);
}

/** Adds the cap of a loop, of which there is room; `first` is the number that new vertices were planned
 * from. */
static void add_cap(vxm_cap_plan *p, vxm_position_set *taken, size_t loop, size_t first) {
  vxm_soup *soup = p->soup;
  size_t begin = p->loops.begin[loop], planned = first + p->points[loop], number = soup->vertex_count;
  for (size_t k = p->points[loop]; k < p->points[loop + 1]; k++) {
    double *at = p->caps.points[k];
    for (int a = 0; a < 3; a++)
      at[a] = vxm_repair_state_round(p->state, at[a]);
    const double *toward = vxm_position(soup, p->loops.vertex[begin]);
    if (memcmp(toward, at, 3 * sizeof *at) == 0) /* any other place on the rim does as well */
      toward = vxm_position(soup, p->loops.vertex[begin + 1]);
    find_free(p->state, taken, at, toward);
    memcpy(soup->positions + 3 * soup->vertex_count, at, 3 * sizeof *at);
    vxm_position_set_add(taken, (uint32_t)soup->vertex_count++);
  }
  for (size_t t = p->triangles[loop]; t < p->triangles[loop + 1]; t++) {
    size_t beside = p->edge_face[p->loops.edge[begin]];
    if (soup->face_tags)
      soup->face_tags[soup->face_count] = soup->face_tags[beside];
    if (soup->face_parts)
      soup->face_parts[soup->face_count] = soup->face_parts[beside];
    for (int i = 0; i < 3; i++) {
      uint32_t v = p->caps.triangles[t][i];
      soup->indices[soup->corner_count++] = v < first ? v : (uint32_t)(v - planned + number);
    }
    soup->offsets[++soup->face_count] = soup->corner_count;
  }
}

static bool add_wanted(vxm_cap_plan *p) {
  size_t faces = 0, points = 0, first = p->soup->vertex_count;
  for (size_t l = 0; l < p->loops.count; l++)
    if (p->wanted[l]) {
      faces += p->triangles[l + 1] - p->triangles[l];
      points += p->points[l + 1] - p->points[l];
    }
  if (faces == 0)
    return true;
  vxm_position_set taken;
  bool ready = vxm_position_set_open(&taken, p->soup, first + points, VXM_MERGE_EXACT, &p->error) == VXM_OK &&
               make_room(p, faces, points);
  if (ready) {
    for (size_t v = 0; v < first && points > 0; v++)
      vxm_position_set_add(&taken, (uint32_t)v);
    for (size_t l = 0; l < p->loops.count; l++)
      if (p->wanted[l])
        add_cap(p, &taken, l, first);
    p->state->counts[VXM_PASS_CLOSING] += (int64_t)faces;
  }
  vxm_position_set_close(&taken);
  return ready;
}

int64_t vxm_cap_plan_close(vxm_cap_plan *p) {
  int64_t closed = 0;
  if (!add_wanted(p))
    return -1;
  for (size_t l = 0; l < p->loops.count; l++)
    closed += p->wanted[l];
  if (closed > 0)
    vxm_repair_state_touch(p->state);
  return closed;
}
