/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/holes/fill_fans.h"

#include "mesh/caps.h"
#include "mesh/components.h"
#include "mesh/geometry.h"
#include "repair/state/position_set.h"

#include <string.h>

/** A component whose caps have at least this part of its area is a sheet: closing would fold it flat. The
   solid has the same bound (voxel/parts/parts.c). */
static const double SHEET = 0.75;

typedef struct closing {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_error error;
  double scale;
  size_t most; /**< edges of a loop that is closed */
  vxm_boundary_loops loops;
  vxm_caps caps;
  uint32_t *label; /**< per face: its component */
  size_t component_count;
  size_t *edge_face;          /**< per edge: its first face */
  size_t *triangles, *points; /**< per loop, and one more: where those of its cap begin */
  double *area, *cap_area;    /**< per component */
} closing;

static void *allocate(closing *c, size_t count, size_t size) {
  return vxm_calloc(c->state->context, count, size, &c->error);
}

/* ---- Planning the caps ---- */

static bool find_edge_faces(closing *c) {
  if (vxm_repair_state_edges(c->state, &c->error) != VXM_OK)
    return false;
  const uint32_t *sides = c->state->edges.sides;
  c->edge_face = allocate(c, c->state->edges.count, sizeof *c->edge_face);
  for (size_t f = c->soup->face_count; c->edge_face && f-- > 0;)
    for (uint64_t s = c->soup->offsets[f]; s < c->soup->offsets[f + 1]; s++)
      if (sides[s] != VXM_NO_EDGE)
        c->edge_face[sides[s]] = f;
  return c->edge_face != NULL;
}

static bool face_has(const vxm_soup *soup, size_t face, uint32_t vertex) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  for (size_t i = 0; i < count; i++)
    if (corner[i] == vertex)
      return true;
  return false;
}

/** Whether a triangle over a loop of three edges would not repeat a face. */
static bool is_plain(const closing *c, size_t loop) {
  size_t begin = c->loops.begin[loop];
  if (c->loops.begin[loop + 1] - begin != 3)
    return true;
  const vxm_edge *edge = &c->state->edges.edges[c->loops.edge[begin]];
  size_t face = c->edge_face[c->loops.edge[begin]];
  size_t corners = (size_t)(c->soup->offsets[face + 1] - c->soup->offsets[face]);
  return edge->count == 1 && (corners != 3 || !face_has(c->soup, face, c->loops.vertex[begin + 2]));
}

static uint32_t component_of(const closing *c, size_t loop) {
  return c->label[c->edge_face[c->loops.edge[c->loops.begin[loop]]]];
}

static double triangle_area(const closing *c, const uint32_t *t) {
  vxm_vec3 p =
      vxm_vec3_between(vxm_caps_position(&c->caps, t[1]), vxm_caps_position(&c->caps, t[0]), c->scale);
  vxm_vec3 q =
      vxm_vec3_between(vxm_caps_position(&c->caps, t[2]), vxm_caps_position(&c->caps, t[0]), c->scale);
  return 0.5 * vxm_vec3_length(vxm_vec3_cross(p, q));
}

static bool plan_caps(closing *c) {
  size_t loops = c->loops.count;
  c->triangles = allocate(c, loops + 1, sizeof *c->triangles);
  c->points = allocate(c, loops + 1, sizeof *c->points);
  c->area = allocate(c, c->component_count, sizeof *c->area);
  c->cap_area = allocate(c, c->component_count, sizeof *c->cap_area);
  if (!c->triangles || !c->points || !c->area || !c->cap_area)
    return false;
  for (size_t f = 0; f < c->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(c->soup, f, &count);
    c->area[c->label[f]] += vxm_vec3_length(vxm_polygon_area(c->soup->positions, corner, count, c->scale));
  }
  c->caps = (vxm_caps){.soup = c->soup, .edges = &c->state->edges, .scale = c->scale};
  for (size_t l = 0; l < loops; l++) {
    if (vxm_caps_add(&c->caps, &c->loops, l, is_plain(c, l), &c->error) != VXM_OK)
      return false;
    c->triangles[l + 1] = c->caps.triangle_count;
    c->points[l + 1] = c->caps.point_count;
    for (size_t t = c->triangles[l]; t < c->triangles[l + 1]; t++)
      c->cap_area[component_of(c, l)] += triangle_area(c, c->caps.triangles[t]);
  }
  return true;
}

static bool is_sheet(const closing *c, uint32_t component) {
  return !(c->cap_area[component] < SHEET * c->area[component]);
}

/** Whether a loop is closed. */
static bool is_wanted(const closing *c, size_t loop) {
  return c->loops.begin[loop + 1] - c->loops.begin[loop] <= c->most && !is_sheet(c, component_of(c, loop));
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

static bool grow_marks(closing *c, size_t vertices) {
  uint8_t **marks[2] = {&c->state->gone, &c->state->used};
  for (int i = 0; i < 2; i++) {
    uint8_t *grown = vxm_realloc(c->state->context, *marks[i], vertices, 1, &c->error);
    if (!grown)
      return false;
    memset(grown + c->soup->vertex_count, 0, vertices - c->soup->vertex_count);
    *marks[i] = grown;
  }
  return true;
}

static bool make_room(closing *c, size_t faces, size_t points) {
  vxm_soup *soup = c->soup;
  size_t total = soup->face_count + faces;
  if (vxm_soup_reserve(soup, soup->vertex_count + points, total, soup->corner_count + 3 * faces, &c->error) !=
      VXM_OK)
    return false;
  if (soup->face_tags) {
    uint32_t *tags = vxm_realloc(soup->context, soup->face_tags, total, sizeof *tags, &c->error);
    if (!tags)
      return false;
    soup->face_tags = tags;
  }
  if (soup->face_parts) {
    uint32_t *parts = vxm_realloc(soup->context, soup->face_parts, total, sizeof *parts, &c->error);
    if (!parts)
      return false;
    soup->face_parts = parts;
  }
  if (c->state->turned) {
    uint8_t *turned = vxm_realloc(soup->context, c->state->turned, total, sizeof *turned, &c->error);
    if (!turned)
      return false;
    memset(turned + soup->face_count, VXM_ADDED, faces);
    c->state->turned = turned;
  }
  return grow_marks(c, soup->vertex_count + points);
}

/** Adds the cap of a loop, of which there is room; `first` is the number that new vertices were planned
 * from. */
static void add_cap(closing *c, vxm_position_set *taken, size_t loop, size_t first) {
  vxm_soup *soup = c->soup;
  size_t begin = c->loops.begin[loop], planned = first + c->points[loop], number = soup->vertex_count;
  for (size_t k = c->points[loop]; k < c->points[loop + 1]; k++) {
    double *p = c->caps.points[k];
    for (int a = 0; a < 3; a++)
      p[a] = vxm_repair_state_round(c->state, p[a]);
    const double *toward = vxm_position(soup, c->loops.vertex[begin]);
    if (memcmp(toward, p, 3 * sizeof *p) == 0) /* any other place on the rim does as well */
      toward = vxm_position(soup, c->loops.vertex[begin + 1]);
    find_free(c->state, taken, p, toward);
    memcpy(soup->positions + 3 * soup->vertex_count, p, 3 * sizeof *p);
    vxm_position_set_add(taken, (uint32_t)soup->vertex_count++);
  }
  for (size_t t = c->triangles[loop]; t < c->triangles[loop + 1]; t++) {
    size_t beside = c->edge_face[c->loops.edge[begin]];
    if (soup->face_tags)
      soup->face_tags[soup->face_count] = soup->face_tags[beside];
    if (soup->face_parts)
      soup->face_parts[soup->face_count] = soup->face_parts[beside];
    for (int i = 0; i < 3; i++) {
      uint32_t v = c->caps.triangles[t][i];
      soup->indices[soup->corner_count++] = v < first ? v : (uint32_t)(v - planned + number);
    }
    soup->offsets[++soup->face_count] = soup->corner_count;
  }
}

static bool add_caps(closing *c) {
  size_t faces = 0, points = 0, first = c->soup->vertex_count;
  for (size_t l = 0; l < c->loops.count; l++)
    if (is_wanted(c, l)) {
      faces += c->triangles[l + 1] - c->triangles[l];
      points += c->points[l + 1] - c->points[l];
    }
  if (faces == 0)
    return true;
  vxm_position_set taken;
  bool ready = vxm_position_set_open(&taken, c->soup, first + points, VXM_MERGE_EXACT, &c->error) == VXM_OK &&
               make_room(c, faces, points);
  if (ready) {
    for (size_t v = 0; v < first && points > 0; v++)
      vxm_position_set_add(&taken, (uint32_t)v);
    for (size_t l = 0; l < c->loops.count; l++)
      if (is_wanted(c, l))
        add_cap(c, &taken, l, first);
    c->state->counts[VXM_PASS_CLOSING] += (int64_t)faces;
  }
  vxm_position_set_close(&taken);
  return ready;
}

/** Components with loops that stay open; each is counted at its first loop and then marked as counted. */
static int64_t count_sheets(closing *c) {
  int64_t count = 0;
  for (size_t l = 0; l < c->loops.count; l++) {
    uint32_t component = component_of(c, l);
    if (is_sheet(c, component)) {
      count++;
      c->cap_area[component] = -1;
    }
  }
  return count;
}

static bool plan(closing *c) {
  c->label = allocate(c, c->soup->face_count, sizeof *c->label);
  if (!c->label || !find_edge_faces(c))
    return false;
  if (vxm_boundary_loops_build(&c->loops, c->soup, &c->state->edges, &c->error) != VXM_OK)
    return false;
  if (vxm_components(c->state->context, c->soup, NULL, c->label, &c->component_count, &c->error) != VXM_OK)
    return false;
  return plan_caps(c);
}

static void release(closing *c) {
  vxm_context *context = c->state->context;
  if (c->caps.soup)
    vxm_caps_destroy(&c->caps);
  if (c->loops.context)
    vxm_boundary_loops_destroy(&c->loops);
  vxm_free(context, c->cap_area);
  vxm_free(context, c->area);
  vxm_free(context, c->points);
  vxm_free(context, c->triangles);
  vxm_free(context, c->edge_face);
  vxm_free(context, c->label);
}

static closing begin(vxm_repair_state *state, size_t most) {
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  return (closing){.state = state,
                   .soup = state->soup,
                   .error = VXM_ERROR_INIT,
                   .scale = vxm_unit_scale_of(extent.bounds).scale,
                   .most = most};
}

static vxm_status end(closing *c, bool done, vxm_error *error) {
  release(c);
  if (!done)
    vxm_error_pass(error, &c->error);
  return done ? VXM_OK : c->error.code;
}

vxm_status vxm_fill_fans(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error) {
  closing c = begin(state, most);
  bool done = plan(&c) && add_caps(&c);
  *closed = 0;
  if (done) {
    for (size_t l = 0; l < c.loops.count; l++)
      *closed += is_wanted(&c, l);
    state->open_parts = count_sheets(&c);
    if (*closed > 0)
      vxm_repair_state_touch(state);
  }
  return end(&c, done, error);
}

vxm_status vxm_find_sheets(uint8_t *faces, vxm_repair_state *state, vxm_error *error) {
  closing c = begin(state, SIZE_MAX);
  bool done = plan(&c);
  for (size_t f = 0; done && f < c.soup->face_count; f++)
    faces[f] = is_sheet(&c, c.label[f]);
  if (done)
    state->open_parts = count_sheets(&c);
  return end(&c, done, error);
}
