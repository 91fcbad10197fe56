/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/sheets/sheet_offsets.h"

#include "base/exact_math.h"
#include "mesh/unit_scale.h"
#include "repair/sheets/offset_vector.h"

#include <string.h>

/** Halvings of the distance at most, where faces are turned over; rounds in which planes get more weight that
 * a vertex is to lie beyond and does not. */
enum { HALVINGS = 8, ROUNDS = 8 };

/** As VXM_FLAT, for vertices that are to lie beyond planes which nearly face each other. */
static const double SHARP = 1e-9;

/** Vertices of plates move by multiples of this part of the distance, so that plates which are to lie in one
 * plane do, whatever their normals were rounded to; a union leaves slivers between them else. Were they put
 * on a lattice, plates would not be as thick as they are to be. */
static const double STEP = 0x1p-32;

/** What a cut across a crease costs, as angles about the vertex times squared distances: rather the flat side
 * of an edge is cut than the crease beside it. */
static const double CREASE = 0.1;

typedef struct offsetting {
  vxm_sheet_sides *sides;
  vxm_sheet_offsets *out;
  double scale;     /**< of the frame in which areas are computed */
  vxm_vec3 *normal; /**< per triangle: of its front; zero if it has none */
  vxm_vec3 *vector; /**< per vertex of the surface: for a distance of 1 */
  uint8_t *halved;  /**< per vertex: how often its distance was */
  uint32_t *place;  /**< per vertex: that of the sheets which it belongs to */
} offsetting;

static void find_normals(offsetting *o) {
  const vxm_soup *soup = o->sides->soup;
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_vec3 n = vxm_polygon_area(soup->positions, soup->indices + 3 * f, 3, o->scale);
    double length = vxm_vec3_length(n);
    o->normal[f] = length > 0 ? (vxm_vec3){n.x / length, n.y / length, n.z / length} : (vxm_vec3){0, 0, 0};
  }
}

/** Angle of the triangle at a corner. */
static double angle_at(const offsetting *o, uint32_t corner) {
  const vxm_soup *soup = o->sides->soup;
  const double *p = vxm_position(soup, vxm_sheet_vertex(o->sides, corner));
  vxm_vec3 a =
      vxm_vec3_between(vxm_position(soup, vxm_sheet_vertex(o->sides, vxm_sheet_next(corner))), p, o->scale);
  vxm_vec3 b = vxm_vec3_between(vxm_position(soup, vxm_sheet_vertex(o->sides, vxm_sheet_previous(corner))), p,
                                o->scale);
  return vxm_angle(vxm_vec3_length(vxm_vec3_cross(a, b)), vxm_vec3_dot(a, b));
}

/** Normal of the side that a corner is of. */
static vxm_vec3 normal_of(const offsetting *o, uint32_t corner) {
  vxm_vec3 n = o->normal[corner / 6];
  return corner % 2 ? (vxm_vec3){-n.x, -n.y, -n.z} : n;
}

static void add_plane(const offsetting *o, vxm_offset_sums *sums, uint32_t corner) {
  vxm_vec3 n = normal_of(o, corner);
  if (n.x != 0 || n.y != 0 || n.z != 0)
    vxm_offset_sums_add(sums, n, angle_at(o, corner));
}

/* ---- Feet of flaps ---- */

/** Whether a walk that begins at the front of a rim ends at its back; *all gets the planes along it. */
static bool ends_at_back(const offsetting *o, uint32_t rim, uint32_t corner, vxm_offset_sums *all) {
  uint32_t edge = vxm_sheet_other_edge(corner, rim);
  *all = (vxm_offset_sums){0};
  do
    add_plane(o, all, corner);
  while (vxm_sheet_step(o->sides, &corner, &edge));
  return edge == (rim ^ 1);
}

/** Cuts the walk from the front of a rim to its back where both pieces fit their planes best. */
static void cut_walk(offsetting *o, uint32_t rim, uint32_t corner, const vxm_offset_sums *all) {
  uint32_t edge = vxm_sheet_other_edge(corner, rim), best = VXM_NO_CORNER;
  uint32_t vertex = vxm_sheet_vertex(o->sides, corner);
  vxm_offset_sums before = {0};
  double least = INFINITY;
  for (;;) {
    uint32_t crossed = edge;
    vxm_vec3 normal = normal_of(o, corner);
    add_plane(o, &before, corner);
    if (!vxm_sheet_step(o->sides, &corner, &edge))
      break;
    vxm_offset_sums after = vxm_offset_sums_without(all, &before);
    double sum = vxm_offset_residual(&before, vxm_offset_vector(&before, VXM_FLAT)) +
                 vxm_offset_residual(&after, vxm_offset_vector(&after, VXM_FLAT)) +
                 CREASE * (1 - vxm_vec3_dot(normal, normal_of(o, corner)));
    if (sum < least) {
      least = sum;
      best = crossed;
    }
  }
  if (best != VXM_NO_CORNER)
    vxm_sheet_cut(o->sides, best, vertex);
}

static vxm_status part_feet(offsetting *o, vxm_error *error) {
  vxm_sheet_sides *sides = o->sides;
  vxm_offset_sums all;
  vxm_status status = VXM_OK;
  for (uint32_t front = 0; front < sides->count && status == VXM_OK; front += 2) {
    uint32_t ends[2] = {front, vxm_sheet_next(front)};
    for (int e = 0; e < 2 && vxm_sheet_is_rim(sides, front); e++)
      if (ends_at_back(o, front, ends[e], &all))
        cut_walk(o, front, ends[e], &all);
    status = vxm_check_cancelled_at(front / 2, o->out->context, error);
  }
  return status;
}

/* ---- Vertices ---- */

/** Numbers the walk that a corner is in, and adds up its planes. */
static vxm_offset_sums number_walk(offsetting *o, uint32_t corner) {
  uint32_t edge, at = vxm_sheet_walk_begin(o->sides, corner, &edge);
  vxm_offset_sums sums = {0};
  do {
    o->out->vertex[at] = o->out->count;
    add_plane(o, &sums, at);
  } while (vxm_sheet_step(o->sides, &at, &edge) && o->out->vertex[at] == VXM_NO_CORNER);
  return sums;
}

/** Adds those planes of a walk once more that a vector does not lie beyond; false if there is none. */
static bool add_missed(const offsetting *o, vxm_offset_sums *sums, uint32_t corner, vxm_vec3 vector) {
  uint32_t edge, at = vxm_sheet_walk_begin(o->sides, corner, &edge), first = at;
  bool any = false;
  do
    if (vxm_vec3_dot(normal_of(o, at), vector) < 0) {
      for (int i = 0; i < 2; i++)
        add_plane(o, sums, at);
      any = true;
    }
  while (vxm_sheet_step(o->sides, &at, &edge) && at != first);
  return any;
}

/** Where the vertex of a walk goes: beyond no face about it; where none lies beyond all it stays. */
static vxm_vec3 vector_of(const offsetting *o, uint32_t corner, vxm_offset_sums sums) {
  for (int round = 0; round < ROUNDS; round++) {
    vxm_vec3 vector = vxm_offset_vector(&sums, round == 0 ? VXM_FLAT : SHARP);
    if (!add_missed(o, &sums, corner, vector))
      return vector;
  }
  return (vxm_vec3){0, 0, 0};
}

static vxm_status number_corners(offsetting *o, vxm_error *error) {
  vxm_status status = VXM_OK;
  memset(o->out->vertex, 0xff, o->sides->count * sizeof *o->out->vertex);
  for (uint32_t c = 0; c < o->sides->count && status == VXM_OK; c++) {
    if (o->out->vertex[c] == VXM_NO_CORNER) {
      vxm_offset_sums sums = number_walk(o, c);
      o->vector[o->out->count] = vector_of(o, c, sums);
      o->place[o->out->count++] = vxm_sheet_vertex(o->sides, c);
    }
    status = vxm_check_cancelled_at(c, o->out->context, error);
  }
  return status;
}

static void place_vertices(offsetting *o, double distance) {
  for (uint32_t v = 0; v < o->out->count; v++) {
    const double *from = vxm_position(o->sides->soup, o->place[v]);
    double part = ldexp(distance, -o->halved[v]), *p = o->out->positions + 3 * (size_t)v;
    const double by[3] = {o->vector[v].x, o->vector[v].y, o->vector[v].z};
    for (int a = 0; a < 3; a++)
      p[a] = from[a] + part * (STEP * rint(by[a] / STEP));
  }
}

/** Whether the side of a triangle looks the other way where it has come to lie. */
static bool is_turned_over(const offsetting *o, uint32_t side) {
  const uint32_t corners[3] = {o->out->vertex[side], o->out->vertex[side + 2], o->out->vertex[side + 4]};
  vxm_vec3 now = vxm_polygon_area(o->out->positions, corners, 3, o->scale), n = o->normal[side / 6];
  return vxm_vec3_dot(now, n) < 0;
}

/** Halves the distance at the corners of triangles that are turned over; false if there is none. */
static bool draw_nearer(offsetting *o) {
  bool any = false;
  uint8_t *mark = o->halved;
  enum { MARKED = 0x80 };
  for (uint32_t side = 0; side < o->sides->count; side += side % 2 ? 5 : 1)
    if (is_turned_over(o, side))
      for (uint32_t j = 0; j < 6; j += 2)
        mark[o->out->vertex[side + j]] |= MARKED;
  for (uint32_t v = 0; v < o->out->count; v++)
    if (mark[v] & MARKED) {
      mark[v] = (uint8_t)((mark[v] & ~MARKED) + 1);
      any = true;
    }
  return any;
}

static vxm_status check_places(const offsetting *o, vxm_error *error) {
  for (uint32_t v = 0; v < o->out->count; v++)
    if (!vxm_is_finite(o->out->positions + 3 * (size_t)v))
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "a plate reaches beyond the numbers; choose a smaller thickness, or keep sheets");
  return VXM_OK;
}

vxm_status vxm_sheet_offsets_find(vxm_sheet_offsets *out, vxm_sheet_sides *sides, double distance,
                                  double scale, vxm_error *error) {
  vxm_context *context = sides->soup->context;
  vxm_error local = VXM_ERROR_INIT;
  *out = (vxm_sheet_offsets){.context = context};
  offsetting o = {.sides = sides, .out = out, .scale = scale};
  out->vertex = vxm_alloc(context, sides->count, sizeof *out->vertex, &local);
  out->positions = out->vertex ? vxm_calloc(context, sides->count, 3 * sizeof *out->positions, &local) : NULL;
  o.normal = out->positions ? vxm_calloc(context, sides->count / 6, sizeof *o.normal, &local) : NULL;
  o.vector = o.normal ? vxm_calloc(context, sides->count, sizeof *o.vector, &local) : NULL;
  o.halved = o.vector ? vxm_calloc(context, sides->count, 1, &local) : NULL;
  o.place = o.halved ? vxm_calloc(context, sides->count, sizeof *o.place, &local) : NULL;
  if (o.place) {
    find_normals(&o);
    if (part_feet(&o, &local) == VXM_OK && number_corners(&o, &local) == VXM_OK) {
      place_vertices(&o, distance);
      for (int i = 0; i < HALVINGS && draw_nearer(&o); i++)
        place_vertices(&o, distance);
      check_places(&o, &local);
    }
  }
  vxm_free(context, o.place);
  vxm_free(context, o.halved);
  vxm_free(context, o.vector);
  vxm_free(context, o.normal);
  if (local.code != VXM_OK) {
    vxm_sheet_offsets_destroy(out);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_sheet_offsets_destroy(vxm_sheet_offsets *offsets) {
  vxm_free(offsets->context, offsets->positions);
  vxm_free(offsets->context, offsets->vertex);
  *offsets = (vxm_sheet_offsets){.context = offsets->context};
}
