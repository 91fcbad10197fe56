/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Vertices at the same position that belong to different patches would be one again for every program that
 * welds, and the edges between them have too many faces again. So each is moved a very little toward the
 * faces of its own.
 */
#include "mesh/geometry.h"
#include "mesh/weld.h"
#include "repair/state/position_hash.h"
#include "repair/state/repair_state.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/** Of the diagonal: far below any tolerance, and far above the rounding of doubles. */
static const double STEP = 1e-9;
/** Of the shortest edge about a vertex at most, as far as the numbers allow it, for parts that are small. */
static const double STEP_EDGE = 1e-8;
/** Of the longest edge about a vertex: along all axes only if the step is no larger than this. */
static const double FINE = 1e-6;
/** Of the longest edge about a vertex: a larger step would deform the faces, and the vertex stays. */
static const double COARSE = 1.0 / 64;
/** Of the direction's length: along an axis that has less of it nothing has to change. */
static const double AXIS = 0.2;

typedef struct surroundings {
  vxm_vec3 toward;          /**< sum of the directions to the middles of the faces */
  double shortest, longest; /**< edges about the vertex */
} surroundings;

typedef struct moving {
  vxm_repair_state *state;
  vxm_soup *soup;
  uint32_t *map;        /**< vertex: the first one at its position */
  uint32_t *number;     /**< vertex: its place among those that share theirs, or VXM_NO_VERTEX */
  surroundings *around; /**< of those */
  size_t shared;        /**< how many those are */
  double diagonal;
  vxm_position_hash places; /**< what is taken */
} moving;

/* ---- What lies around a vertex ---- */

static vxm_vec3 middle_of(const vxm_soup *soup, const uint32_t *corner, size_t count) {
  vxm_vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < count; i++) {
    const double *p = vxm_position(soup, corner[i]);
    sum =
        (vxm_vec3){sum.x + p[0] / (double)count, sum.y + p[1] / (double)count, sum.z + p[2] / (double)count};
  }
  return sum;
}

static void note_edge(surroundings *s, const double *p, const double *q) {
  double length = vxm_vec3_length(vxm_vec3_between(p, q, 1));
  if (length > 0)
    s->shortest = s->shortest > 0 ? fmin(s->shortest, length) : length;
  s->longest = fmax(s->longest, length);
}

static void look_around(moving *m) {
  for (size_t f = 0; f < m->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(m->soup, f, &count);
    vxm_vec3 middle = middle_of(m->soup, corner, count);
    for (size_t i = 0; i < count; i++) {
      if (m->number[corner[i]] == VXM_NO_VERTEX)
        continue;
      surroundings *s = &m->around[m->number[corner[i]]];
      const double *p = vxm_position(m->soup, corner[i]);
      vxm_vec3 d = {middle.x - p[0], middle.y - p[1], middle.z - p[2]};
      double length = vxm_vec3_length(d);
      if (length > 0)
        s->toward =
            (vxm_vec3){s->toward.x + d.x / length, s->toward.y + d.y / length, s->toward.z + d.z / length};
      note_edge(s, p, vxm_position(m->soup, corner[i + 1 < count ? i + 1 : 0]));
      note_edge(s, p, vxm_position(m->soup, corner[i > 0 ? i - 1 : count - 1]));
    }
  }
}

/* ---- A place for a vertex ---- */

/** What a vertex is to be moved by. */
typedef struct moves {
  double from[3], toward[3]; /**< toward: of length 1 */
  double unit[3];            /**< along each axis: what the numbers that hold the position tell apart */
  double step;               /**< how far to go, where they allow it */
  double fine, coarse;
} moves;

/** The distance to the next number beyond x. */
static double unit_of(const vxm_repair_state *state, double x) {
  x = fabs(x);
  if (state->options.single_precision)
    return (double)nextafterf((float)x, INFINITY) - x;
  return 4 * (nextafter(x, INFINITY) - x);
}

static moves moves_of(const moving *m, uint32_t v, const surroundings *s) {
  const double *p = vxm_position(m->soup, v);
  double length = vxm_vec3_length(s->toward);
  moves by = {.step = fmin(STEP * m->diagonal, STEP_EDGE * s->shortest),
              .fine = (vxm_repair_state_reaches(m->state, VXM_LEVEL_SOLID) ? COARSE : FINE) * s->longest,
              .coarse = COARSE * s->longest};
  const double toward[3] = {s->toward.x, s->toward.y, s->toward.z};
  for (int a = 0; a < 3; a++) {
    by.from[a] = p[a];
    by.toward[a] = length > 0 ? toward[a] / length : sqrt(1.0 / 3); /* any direction where there is none */
    by.unit[a] = unit_of(m->state, p[a]);
  }
  return by;
}

/** Whether a place is free, and no farther than `most` along each axis. */
static bool fits(const moving *m, const moves *by, const double p[3], double most) {
  for (int a = 0; a < 3; a++)
    if (!(fabs(p[a] - by->from[a]) <= most))
      return false;
  return !vxm_position_hash_taken(&m->places, p);
}

/** In the direction of the faces, so that what touched along an edge touches nowhere. */
static bool find_along(const moving *m, const moves *by, double p[3]) {
  for (int quarter = 4; quarter <= 12; quarter++) {
    for (int a = 0; a < 3; a++) {
      double step = by->step * quarter / 4 * fabs(by->toward[a]);
      if (fabs(by->toward[a]) > AXIS)
        step = fmax(step, by->unit[a] * (quarter / 4));
      p[a] = vxm_repair_state_round(m->state, by->from[a] + copysign(step, by->toward[a]));
    }
    if (fits(m, by, p, by->fine))
      return true;
  }
  return false;
}

typedef struct nearby {
  double p[3], distance;
} nearby;

static int by_distance(const void *a, const void *b) {
  const nearby *p = a, *q = b;
  return (p->distance > q->distance) - (p->distance < q->distance);
}

/** Where numbers are coarse: the nearest place that lies on the side of the faces, such as along the one axis
 * on which they are fine. */
static bool find_nearest(const moving *m, const moves *by, double p[3]) {
  enum { STEPS = 4 };
  nearby places[STEPS * STEPS * STEPS];
  int count = 0;
  for (int n = 1; n < STEPS * STEPS * STEPS; n++) {
    const int steps[3] = {n % STEPS, n / STEPS % STEPS, n / STEPS / STEPS};
    nearby *place = &places[count];
    double along = 0, squared = 0;
    for (int a = 0; a < 3; a++) {
      double step = copysign(steps[a] * fmax(by->step, by->unit[a]), by->toward[a]);
      place->p[a] = vxm_repair_state_round(m->state, by->from[a] + step);
      along += step * by->toward[a];
      squared += step * step;
    }
    place->distance = sqrt(squared);
    count += along >= AXIS * place->distance;
  }
  qsort(places, (size_t)count, sizeof *places, by_distance);
  for (int i = 0; i < count; i++)
    if (fits(m, by, places[i].p, by->coarse)) {
      for (int a = 0; a < 3; a++)
        p[a] = places[i].p[a];
      return true;
    }
  return false;
}

/** Whether there is a place. */
static bool move(moving *m, uint32_t v) {
  const surroundings *s = &m->around[m->number[v]];
  moves by = moves_of(m, v, s);
  double to[3], *p = m->soup->positions + 3 * (size_t)v;
  bool found = find_along(m, &by, to) || find_nearest(m, &by, to);
  for (int a = 0; a < 3 && found; a++)
    p[a] = to[a];
  vxm_position_hash_add(&m->places, v);
  return found;
}

/* ---- All of them ---- */

/** Numbers the vertices that share their position with another one that faces have. */
static vxm_status list_shared(moving *m, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t vertices = m->soup->vertex_count;
  uint8_t *seen = vxm_repair_state_scratch(m->state, vertices, sizeof *seen, &status, error);
  for (size_t v = 0; seen && v < vertices; v++)
    if (m->state->used[v] && seen[m->map[v]] < 2)
      seen[m->map[v]]++;
  for (size_t v = 0; seen && v < vertices; v++)
    m->number[v] = m->state->used[v] && seen[m->map[v]] == 2 ? (uint32_t)m->shared++ : VXM_NO_VERTEX;
  vxm_free(m->state->context, seen);
  return status;
}

static int64_t move_all(moving *m) {
  int64_t moved = 0;
  size_t vertices = m->soup->vertex_count;
  for (size_t v = 0; v < vertices; v++)
    if (m->state->used[v])
      vxm_position_hash_add(&m->places, (uint32_t)v);
  look_around(m);
  for (size_t v = 0; v < vertices; v++)
    if (m->number[v] != VXM_NO_VERTEX)
      moved += move(m, (uint32_t)v);
  return moved;
}

static vxm_status move_shared(moving *m, int64_t *moved, vxm_error *error) {
  vxm_repair_state *state = m->state;
  size_t vertices = m->soup->vertex_count;
  vxm_status status = VXM_OK;
  m->number = vxm_repair_state_scratch(state, vertices, sizeof *m->number, &status, error);
  if (status == VXM_OK)
    status = list_shared(m, error);
  if (status == VXM_OK)
    m->around = vxm_repair_state_scratch(state, m->shared, sizeof *m->around, &status, error);
  if (status == VXM_OK && m->shared > 0)
    status = vxm_position_hash_open(&m->places, m->soup, vertices + m->shared, error);
  if (status == VXM_OK && m->shared > 0)
    *moved = move_all(m);
  vxm_position_hash_close(&m->places);
  vxm_free(state->context, m->around);
  vxm_free(state->context, m->number);
  return status;
}

/** What finds no place stays, for the verification to find. */
vxm_status vxm_pass_apart(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD))
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  const double *b = extent.bounds;
  moving m = {
      .state = state, .soup = state->soup, .diagonal = hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2])};
  vxm_status status = VXM_OK;
  int64_t moved = 0;
  size_t distinct, vertices = state->soup->vertex_count;
  m.map = vxm_repair_state_scratch(state, vertices, sizeof *m.map, &status, error);
  if (status == VXM_OK)
    status = vxm_weld_exact(state->context, state->soup->positions, vertices, m.map, &distinct, error);
  if (status == VXM_OK && distinct < vertices)
    status = move_shared(&m, &moved, error);
  vxm_free(state->context, m.map);
  state->counts[VXM_PASS_APART] += moved;
  state->together = (int64_t)m.shared - moved;
  *changed = moved > 0;
  return status;
}
