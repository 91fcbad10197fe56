/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Moves vertices of different patches that have the same position, or lie closer together than other programs
 * tell apart. A program that welds would make one vertex of them, and edges with too many faces would be
 * back. Each is moved a little: toward its own faces, or along an edge that is too short. The same is then
 * done for vertices that would coincide as 32-bit floats, in which many programs hold them, where the faces
 * allow it.
 */
#include "mesh/geometry.h"
#include "repair/manifold/contact_direction.h"
#include "repair/manifold/free_positions.h"
#include "repair/state/repair_state.h"

#include <float.h>
#include <math.h>

/** Of the diagonal: four units in the last place of a 32-bit float. */
static const double STEP = 2.5e-7;
/** Of the least height of the faces about a vertex, so that volumes stay; units may be more. */
static const double STEP_HEIGHT = 1e-6;
/** Of that height: a step that only keeps 32-bit floats apart is no longer, so that no face is turned over.
 */
static const double ROOM = 1.0 / 8;
/** In units of VXM_MERGE_GRID: enough for a difference after rounding and after a small turn of the model. */
static const double STEP_GRID = 5;
/** In units in the last place: of doubles, and of floats where these are not what the file holds. */
static const double STEP_UNITS = 4;
/** Of the diagonal, where a step is to be seen in 32-bit floats though the file holds doubles. */
static const double STEP_FLOAT = 1e-5;
/** Of the longest edge about a vertex: along all axes only if the step is no larger than this, or by STEP. */
static const double FINE = 1e-6;
/** Of the longest edge about a vertex: a larger step would deform the faces, and the vertex stays. */
static const double COARSE = 1.0 / 64;
/** Of the number of faces: where the directions to their middles nearly cancel, the vertex goes inward. */
static const double FLAT = 0.2;

typedef struct surroundings {
  vxm_vec3 toward; /**< sum of the directions to the middles of the faces */
  vxm_vec3 inward; /**< sum of the directions that the faces turn their backs to */
  vxm_vec3 away;   /**< sum of the directions from vertices of its own faces that it is too near to */
  double shortest, longest; /**< edges about the vertex, but for those that are too short */
  double lowest;            /**< of the heights of its triangles; 0 = has none */
  size_t faces;
} surroundings;

typedef struct moving {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_merge_rule rule;
  bool floats_only;     /**< they differ by the rule, and are to differ as 32-bit floats, too */
  uint32_t *map;        /**< vertex: the first one that it would merge with */
  uint32_t *number;     /**< vertex: its place among those that would merge, or VXM_NO_VERTEX */
  surroundings *around; /**< of those */
  vxm_vec3 *contact;    /**< of a solid: the direction in which each leaves what it touches; NULL = is none */
  uint8_t *stays;       /**< of a solid: the first vertex of those that would merge: one of them stays */
  size_t shared;        /**< how many those are */
  double diagonal;
  vxm_position_set taken;  /**< what is taken */
  vxm_position_set floats; /**< what is taken once positions are 32-bit floats */
  vxm_free_positions near;
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

static void add_unit(vxm_vec3 *sum, vxm_vec3 d, double sign) {
  double length = sign * vxm_vec3_length(d);
  if (length != 0)
    *sum = (vxm_vec3){sum->x + d.x / length, sum->y + d.y / length, sum->z + d.z / length};
}

static void note_edge(const moving *m, surroundings *s, uint32_t v, uint32_t other) {
  vxm_vec3 along = vxm_vec3_between(vxm_position(m->soup, v), vxm_position(m->soup, other), 1);
  double length = vxm_vec3_length(along);
  if (m->map[v] == m->map[other])
    add_unit(&s->away, along, 1);
  else
    s->shortest = s->shortest > 0 ? fmin(s->shortest, length) : length;
  s->longest = fmax(s->longest, length);
}

/** The least height of a triangle, unless corners of it are to be moved from each other. */
static void note_height(const moving *m, surroundings *s, const uint32_t corner[3], vxm_vec3 normal) {
  double longest = 0;
  for (int i = 0; i < 3; i++) {
    uint32_t a = corner[i], b = corner[(i + 1) % 3];
    if (m->map[a] == m->map[b])
      return;
    longest = fmax(longest,
                   vxm_vec3_length(vxm_vec3_between(vxm_position(m->soup, a), vxm_position(m->soup, b), 1)));
  }
  double height = longest > 0 ? 2 * vxm_vec3_length(normal) / longest : 0;
  s->lowest = s->lowest > 0 ? fmin(s->lowest, height) : fmax(height, DBL_MIN);
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
      vxm_vec3 normal = vxm_polygon_area(m->soup->positions, corner, count, 1);
      add_unit(&s->toward, (vxm_vec3){middle.x - p[0], middle.y - p[1], middle.z - p[2]}, 1);
      add_unit(&s->inward, normal, -1);
      note_edge(m, s, corner[i], corner[i + 1 < count ? i + 1 : 0]);
      note_edge(m, s, corner[i], corner[i > 0 ? i - 1 : count - 1]);
      if (count == 3)
        note_height(m, s, corner, normal);
      s->faces++;
    }
  }
}

/* ---- A position for a vertex ---- */

/** What tells positions apart. */
typedef enum precision {
  DOUBLES = 0,
  FLOATS,    /**< 32-bit floats, with some units between them, where the faces are large beside that */
  NEXT_FLOAT /**< by a single unit: what such floats do to the faces in any case */
} precision;

/** The distance to the next 32-bit float beyond x. */
static double float_unit(double x) {
  float single = (float)fabs(x);
  return (double)nextafterf(single, INFINITY) - (double)single;
}

/** The least difference between two numbers near x that tells them apart for who reads the file. */
static double unit_of(const moving *m, double x, precision to) {
  double unit = m->state->options.single_precision || to == NEXT_FLOAT ? float_unit(x)
                : to == FLOATS                                         ? STEP_UNITS * float_unit(x)
                               : STEP_UNITS * (nextafter(fabs(x), INFINITY) - fabs(x));
  return m->rule == VXM_MERGE_ROUNDED ? fmax(unit, STEP_GRID * VXM_MERGE_GRID) : unit;
}

/** From those that it is too near to in its own faces, or to the middles of these, or where they lie flat to
 * the side that they turn their backs to. */
static vxm_vec3 direction_of(const surroundings *s) {
  if (vxm_vec3_length(s->away) > 0)
    return s->away;
  if (vxm_vec3_length(s->toward) > FLAT * (double)s->faces)
    return s->toward;
  return (vxm_vec3){s->toward.x + s->inward.x, s->toward.y + s->inward.y, s->toward.z + s->inward.z};
}

static vxm_position_move moves_of(const moving *m, uint32_t v, const surroundings *s, precision to) {
  const double *p = vxm_position(m->soup, v);
  vxm_vec3 direction = direction_of(s), none = {0, 0, 0};
  vxm_vec3 leaving = m->contact && vxm_vec3_length(s->away) == 0 ? m->contact[m->number[v]] : none;
  if (vxm_vec3_length(leaving) > 0)
    direction = leaving;
  double length = vxm_vec3_length(direction);
  double height = s->lowest > 0 ? fmin(s->lowest, s->shortest) : s->shortest;
  vxm_position_move by = {.floats = to != DOUBLES,
                          .straight = vxm_vec3_length(leaving) > 0,
                          .step = fmin(STEP * m->diagonal, STEP_HEIGHT * height),
                          .coarse = COARSE * s->longest};
  if (to != DOUBLES)
    by.coarse = fmin(to == FLOATS ? fmin(by.coarse, ROOM * height) : by.coarse, STEP_FLOAT * m->diagonal);
  by.fine = fmin(by.coarse, vxm_repair_state_reaches(m->state, VXM_LEVEL_SOLID)
                                ? by.coarse
                                : fmax(FINE * s->longest, 3 * by.step));
  const double toward[3] = {direction.x, direction.y, direction.z};
  for (int a = 0; a < 3; a++) {
    by.from[a] = p[a];
    by.toward[a] = length > 0 ? toward[a] / length : sqrt(1.0 / 3); /* any direction where there is none */
    by.unit[a] = unit_of(m, p[a], to);
  }
  return by;
}

/** Whether there is a free position. */
static bool move(moving *m, uint32_t v) {
  const surroundings *s = &m->around[m->number[v]];
  double to[3], *p = m->soup->positions + 3 * (size_t)v;
  static const precision first[] = {FLOATS, DOUBLES}, then[] = {FLOATS, NEXT_FLOAT};
  bool found = false;
  for (int i = m->state->options.single_precision || m->state->union_try.doubles_only; i < 2 && !found; i++) {
    vxm_position_move by = moves_of(m, v, s, m->floats_only ? then[i] : first[i]);
    found = vxm_free_positions_find(&m->near, v, &by, to);
  }
  for (int a = 0; a < 3 && found; a++)
    p[a] = to[a];
  vxm_position_set_add(&m->taken, v);
  vxm_position_set_add(&m->floats, v);
  return found;
}

/* ---- All of them ---- */

/** Numbers the vertices that would merge with another one that faces have. */
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

/** Lets one vertex of each position stay that cannot be moved into the solid, as the others are: there is
 * nowhere that it would be better off. */
static void let_stay(moving *m) {
  for (size_t v = 0; v < m->soup->vertex_count; v++) {
    if (m->number[v] == VXM_NO_VERTEX || m->stays[m->map[v]] ||
        vxm_vec3_length(m->contact[m->number[v]]) > 0 || vxm_vec3_length(m->around[m->number[v]].away) > 0)
      continue;
    m->stays[m->map[v]] = 1;
    m->number[v] = VXM_NO_VERTEX;
    m->shared--;
  }
}

static int64_t move_all(moving *m) {
  int64_t moved = 0;
  size_t vertices = m->soup->vertex_count;
  for (size_t v = 0; v < vertices; v++)
    if (m->state->used[v]) {
      vxm_position_set_add(&m->taken, (uint32_t)v);
      vxm_position_set_add(&m->floats, (uint32_t)v);
    }
  look_around(m);
  if (m->contact)
    let_stay(m);
  for (size_t v = 0; v < vertices; v++)
    if (m->number[v] != VXM_NO_VERTEX)
      moved += move(m, (uint32_t)v);
  return moved;
}

/** Where the faces bound a solid, and look outward. */
static vxm_status look_for_contacts(moving *m, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (!vxm_repair_state_reaches(m->state, VXM_LEVEL_SOLID) || m->state->counts[VXM_PASS_UNION] == 0)
    return status;
  m->contact = vxm_repair_state_scratch(m->state, m->shared, sizeof *m->contact, &status, error);
  if (status == VXM_OK)
    m->stays = vxm_repair_state_scratch(m->state, m->soup->vertex_count, 1, &status, error);
  return status == VXM_OK ? vxm_contact_directions(m->contact, m->soup, m->map, m->number, m->shared, error)
                          : status;
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
    status = vxm_position_set_open(&m->taken, m->soup, vertices + m->shared, m->rule, error);
  if (status == VXM_OK && m->shared > 0)
    status = vxm_position_set_open(&m->floats, m->soup, vertices + m->shared, VXM_MERGE_FLOAT, error);
  m->near = (vxm_free_positions){.taken = &m->taken,
                                 .floats = &m->floats,
                                 .number = m->number,
                                 .single_precision = state->options.single_precision};
  if (status == VXM_OK && m->shared > 0)
    m->near.full = vxm_repair_state_scratch(state, VXM_FULL_POSITIONS, sizeof *m->near.full, &status, error);
  if (status == VXM_OK && m->shared > 0)
    status = look_for_contacts(m, error);
  if (status == VXM_OK && m->shared > 0)
    *moved = move_all(m);
  vxm_free(state->context, m->near.full);
  vxm_free(state->context, m->contact);
  vxm_free(state->context, m->stays);
  m->contact = NULL;
  m->stays = NULL;
  vxm_position_set_close(&m->floats);
  vxm_position_set_close(&m->taken);
  vxm_free(state->context, m->around);
  vxm_free(state->context, m->number);
  return status;
}

/** Moves the vertices apart that merge by `rule`. */
static vxm_status move_by(moving *m, vxm_merge_rule rule, int64_t *moved, vxm_error *error) {
  vxm_repair_state *state = m->state;
  size_t vertices = state->soup->vertex_count;
  vxm_status status = VXM_OK;
  *moved = 0;
  m->shared = 0;
  m->map = vxm_repair_state_scratch(state, vertices, sizeof *m->map, &status, error);
  if (status == VXM_OK)
    status = vxm_merge_map(state->context, state->soup->positions, vertices, rule, m->map, error);
  if (status == VXM_OK)
    status = move_shared(m, moved, error);
  vxm_free(state->context, m->map);
  state->counts[VXM_PASS_PERTURB_COINCIDENT] += *moved;
  return status;
}

/** Whether the extent's numbers are 32-bit floats at all. */
static bool are_floats(const vxm_extent *extent) {
  for (int i = 0; i < 6; i++)
    if (!(fabs(extent->bounds[i]) < (double)FLT_MAX))
      return false;
  return true;
}

/** What finds no free position stays, for the verification to find. */
vxm_status vxm_pass_perturb_coincident(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD))
    return VXM_OK;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  moving m = {.state = state, .soup = state->soup, .diagonal = vxm_extent_diagonal(extent.bounds)};
  m.rule = vxm_merge_rule_of(m.diagonal);
  int64_t moved, as_floats = 0;
  vxm_status status = move_by(&m, m.rule, &moved, error);
  state->unparted_vertices = (int64_t)m.shared - moved;
  m.floats_only = true;
  if (status == VXM_OK && !state->options.single_precision && !state->union_try.doubles_only &&
      are_floats(&extent))
    status = move_by(&m, VXM_MERGE_FLOAT, &as_floats, error);
  *changed = moved > 0 || as_floats > 0;
  if (*changed)
    vxm_repair_state_move(state);
  return status;
}
