/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/caps.h"

#include "base/hash.h"
#include "mesh/geometry.h"

#include <string.h>

enum {
  LONG = 64,            /**< edges beyond which a loop is cut */
  SHORT = 6,            /**< edges from which a loop far from flat is cut */
  SAMPLES = 48,         /**< vertices of a loop between which chords are tried */
  PENDING_MAX = 96,     /**< parts of a loop that wait to be closed */
  TESTS_PER_EDGE = 200, /**< chords and edges looked at for all cuts of a loop */
  TESTS_FREE = 20000
};

static const double CHORD_PART = 0.25; /**< of the walk between its ends, at most */
static const double SLIT_PART = 0.03;  /**< the same where a flat loop is cut: at the mouth of a slit */
static const double FLAT = 0.5;        /**< vector area by area of the fan: less is far from flat */
static const double NO_SLIT = 0.9;     /**< the same: more has no slit that matters */

/** One edge of a loop, from a vertex to that of the next step. */
typedef struct vxm_cap_step {
  uint32_t from;
  int8_t turn; /**< 1: the cap runs along it as the loop does, -1: against it */
  bool chord;  /**< not an edge of the soup */
} step;

const double *vxm_caps_position(const vxm_caps *caps, uint32_t vertex) {
  size_t known = caps->soup->vertex_count;
  return vertex < known ? vxm_position(caps->soup, vertex) : caps->points[vertex - known];
}

double vxm_caps_area(const vxm_caps *caps, size_t first, size_t end) {
  double area = 0;
  for (size_t t = first; t < end; t++) {
    const uint32_t *v = caps->triangles[t];
    const double *origin = vxm_caps_position(caps, v[0]);
    vxm_vec3 u = vxm_vec3_between(vxm_caps_position(caps, v[1]), origin, caps->scale);
    vxm_vec3 w = vxm_vec3_between(vxm_caps_position(caps, v[2]), origin, caps->scale);
    area += vxm_vec3_length(vxm_vec3_cross(u, w)) / 2;
  }
  return area;
}

void vxm_caps_destroy(vxm_caps *caps) {
  vxm_context *context = caps->soup->context;
  vxm_free(context, caps->triangles);
  vxm_free(context, caps->points);
  vxm_free(context, caps->steps);
  vxm_free(context, caps->chords);
  vxm_free(context, caps->along);
  *caps = (vxm_caps){.soup = caps->soup};
}

static vxm_vec3 between(const vxm_caps *caps, uint32_t p, uint32_t q) {
  return vxm_vec3_between(vxm_caps_position(caps, p), vxm_caps_position(caps, q), caps->scale);
}

static int8_t majority(const step *steps, size_t count) {
  size_t forward = 0;
  for (size_t i = 0; i < count; i++)
    forward += steps[i].turn > 0;
  return 2 * forward >= count ? 1 : -1;
}

static uint32_t vertex_after(const step *steps, size_t count, size_t i) {
  return steps[i + 1 < count ? i + 1 : 0].from;
}

/* ---- Triangles ---- */

static vxm_status add_triangle(vxm_caps *caps, uint32_t a, uint32_t b, uint32_t c, int8_t turn,
                               vxm_error *error) {
  void *triangles = caps->triangles;
  vxm_status status = vxm_grow(caps->soup->context, &triangles, &caps->triangle_capacity,
                               caps->triangle_count + 1, sizeof *caps->triangles, error);
  if (status != VXM_OK)
    return status;
  caps->triangles = triangles;
  uint32_t *triangle = caps->triangles[caps->triangle_count++];
  triangle[0] = turn > 0 ? a : b;
  triangle[1] = turn > 0 ? b : a;
  triangle[2] = c;
  return VXM_OK;
}

static vxm_status add_point(vxm_caps *caps, const double point[3], uint32_t *vertex, vxm_error *error) {
  size_t number = caps->soup->vertex_count + caps->point_count;
  if (number >= VXM_VERTICES_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "closing: more than %zu vertices: split the mesh",
                    VXM_VERTICES_MAX);
  void *points = caps->points;
  vxm_status status = vxm_grow(caps->soup->context, &points, &caps->point_capacity, caps->point_count + 1,
                               sizeof *caps->points, error);
  if (status != VXM_OK)
    return status;
  caps->points = points;
  memcpy(caps->points[caps->point_count++], point, 3 * sizeof *point);
  *vertex = (uint32_t)number;
  return VXM_OK;
}

/** Centroid of the curve: each edge counts by its length. */
static void centroid_of(const vxm_caps *caps, const step *steps, size_t count, double centroid[3]) {
  double sum[3] = {0, 0, 0}, total = 0;
  const double *origin = vxm_caps_position(caps, steps[0].from);
  for (size_t i = 0; i < count; i++) {
    uint32_t from = steps[i].from, to = vertex_after(steps, count, i);
    double length = vxm_vec3_length(between(caps, to, from));
    vxm_vec3 p = between(caps, from, steps[0].from), q = between(caps, to, steps[0].from);
    sum[0] += length * (p.x + q.x);
    sum[1] += length * (p.y + q.y);
    sum[2] += length * (p.z + q.z);
    total += 2 * length;
  }
  for (int a = 0; a < 3; a++)
    centroid[a] = origin[a] + (total > 0 ? sum[a] / total : 0) / caps->scale;
}

static vxm_status cone(vxm_caps *caps, const step *steps, size_t count, vxm_error *error) {
  double centroid[3];
  uint32_t apex = 0;
  centroid_of(caps, steps, count, centroid);
  vxm_status status = add_point(caps, centroid, &apex, error);
  for (size_t i = 0; i < count && status == VXM_OK; i++)
    status = add_triangle(caps, steps[i].from, vertex_after(steps, count, i), apex, steps[i].turn, error);
  return status;
}

/* ---- Edges between old vertices: each may be made once, so that no two triangles have the same corners ----
 */

/** The slot that has the key, or a free one. */
static size_t chord_slot(const uint64_t *chords, size_t slots, uint64_t key) {
  size_t slot = (size_t)vxm_mix(key) & (slots - 1);
  while (chords[slot] != 0 && chords[slot] != key)
    slot = (slot + 1) & (slots - 1);
  return slot;
}

static bool is_edge(const vxm_caps *caps, uint32_t p, uint32_t q) {
  uint64_t key = vxm_edge_key(p, q);
  if (caps->chord_slots > 0 && caps->chords[chord_slot(caps->chords, caps->chord_slots, key)] == key)
    return true;
  return vxm_edges_find(caps->edges, p, q) < caps->edges->count;
}

static vxm_status add_chord(vxm_caps *caps, uint32_t p, uint32_t q, vxm_error *error) {
  if (2 * (caps->chord_count + 1) > caps->chord_slots) {
    size_t slots = caps->chord_slots > 0 ? 2 * caps->chord_slots : 64;
    vxm_status status = VXM_OK;
    uint64_t *chords = vxm_try_calloc(caps->soup->context, slots, sizeof *chords, &status, error);
    if (!chords)
      return status;
    for (size_t i = 0; i < caps->chord_slots; i++)
      if (caps->chords[i] != 0)
        chords[chord_slot(chords, slots, caps->chords[i])] = caps->chords[i];
    vxm_free(caps->soup->context, caps->chords);
    caps->chords = chords;
    caps->chord_slots = slots;
  }
  caps->chords[chord_slot(caps->chords, caps->chord_slots, vxm_edge_key(p, q))] = vxm_edge_key(p, q);
  caps->chord_count++;
  return VXM_OK;
}

/** Two triangles, along the shorter diagonal that is not an edge yet. */
static vxm_status close_four(vxm_caps *caps, const step *steps, vxm_error *error) {
  uint32_t v[4] = {steps[0].from, steps[1].from, steps[2].from, steps[3].from};
  double length[2] = {vxm_vec3_length(between(caps, v[0], v[2])), vxm_vec3_length(between(caps, v[1], v[3]))};
  bool taken[2] = {is_edge(caps, v[0], v[2]), is_edge(caps, v[1], v[3])};
  if (taken[0] && taken[1])
    return cone(caps, steps, 4, error);
  size_t first = taken[0] || (!taken[1] && length[1] < length[0]) ? 1 : 0;
  int8_t turn = majority(steps, 4);
  uint32_t a = v[first], b = v[first + 1], c = v[first + 2], d = v[(first + 3) % 4];
  vxm_status status = add_chord(caps, a, c, error);
  if (status == VXM_OK)
    status = add_triangle(caps, a, b, c, turn, error);
  return status == VXM_OK ? add_triangle(caps, c, d, a, turn, error) : status;
}

/* ---- Cutting ---- */

/** The vector area of the fan by its area: 1 where it is plane and nothing turns back. */
static double flatness(const vxm_caps *caps, const step *steps, size_t count) {
  vxm_vec3 sum = {0, 0, 0};
  double centroid[3], area = 0;
  centroid_of(caps, steps, count, centroid);
  for (size_t i = 0; i < count; i++) {
    vxm_vec3 p = vxm_vec3_between(vxm_caps_position(caps, steps[i].from), centroid, caps->scale);
    vxm_vec3 q =
        vxm_vec3_between(vxm_caps_position(caps, vertex_after(steps, count, i)), centroid, caps->scale);
    vxm_vec3 cross = vxm_vec3_cross(p, q);
    sum = vxm_vec3_sum(sum, cross);
    area += vxm_vec3_length(cross);
  }
  return area > 0 ? vxm_vec3_length(sum) / area : 1;
}

/** Between which steps to cut a loop, if it is to be cut. */
typedef struct cut {
  bool found;
  size_t i, j; /**< steps, i < j */
} cut;

/** The chord that is shortest against the shorter of the two walks between its ends, of those sampled, and
 * shorter than a part of it. */
static cut find_cut(const vxm_caps *caps, const step *steps, size_t count, double part) {
  size_t samples = count < SAMPLES ? count : SAMPLES;
  double *along = caps->along, best = part;
  cut found = {0};
  along[0] = 0;
  for (size_t i = 0; i < count; i++)
    along[i + 1] = along[i] + vxm_vec3_length(between(caps, steps[i].from, vertex_after(steps, count, i)));
  for (size_t p = 0; p < samples; p++)
    for (size_t q = p + 1; q < samples; q++) {
      size_t i = p * count / samples, j = q * count / samples;
      uint32_t from = steps[i].from, to = steps[j].from;
      double walk = along[j] - along[i], around = along[count] - walk;
      double chord = vxm_vec3_length(between(caps, from, to));
      walk = walk < around ? walk : around;
      if (j - i < 2 || count - (j - i) < 2 || from == to || !(chord < best * walk) || is_edge(caps, from, to))
        continue;
      best = chord / walk;
      found = (cut){true, i, j};
    }
  return found;
}

/** Puts the two parts in the place of the loop that begins at `begin`; they are two steps more. */
static void split(step *steps, size_t begin, size_t count, cut at, step *spare, size_t parts[2]) {
  step *loop = steps + begin;
  size_t inner = at.j - at.i;
  int8_t turn = majority(loop, count);
  uint32_t i_vertex = loop[at.i].from, j_vertex = loop[at.j].from;
  size_t next = 0;
  for (size_t k = at.i; k < at.j; k++)
    spare[next++] = loop[k];
  spare[next++] = (step){j_vertex, turn, true};
  parts[0] = next;
  for (size_t k = 0; k < count - inner; k++)
    spare[next++] = loop[(at.j + k) % count];
  spare[next++] = (step){i_vertex, turn, true};
  parts[1] = next - parts[0];
  memcpy(loop, spare, next * sizeof *spare);
}

/** Room for a loop of so many steps, cut to the end: each cut adds two steps and leaves parts of three and
 * more. Behind the loops lies a spare copy. */
static vxm_status make_room(vxm_caps *caps, size_t count, vxm_error *error) {
  void *steps = caps->steps, *along = caps->along;
  vxm_status status =
      vxm_grow(caps->soup->context, &steps, &caps->step_capacity, 4 * count + 2, sizeof *caps->steps, error);
  caps->steps = steps;
  if (status == VXM_OK)
    status =
        vxm_grow(caps->soup->context, &along, &caps->along_capacity, count + 1, sizeof *caps->along, error);
  caps->along = along;
  return status;
}

static vxm_status close_part(vxm_caps *caps, const step *steps, size_t count, bool plain, vxm_error *error) {
  /* no face has a side along a chord, so none has the corners of a triangle with one */
  if (count == 3 && (plain || steps[0].chord || steps[1].chord || steps[2].chord))
    return add_triangle(caps, steps[0].from, steps[1].from, steps[2].from, majority(steps, 3), error);
  return count == 4 ? close_four(caps, steps, error) : cone(caps, steps, count, error);
}

vxm_status vxm_caps_add(vxm_caps *caps, const vxm_boundary_loops *loops, size_t loop, bool plain,
                        vxm_error *error) {
  size_t begin = loops->begin[loop], count = loops->begin[loop + 1] - begin;
  vxm_status status = make_room(caps, count, error);
  if (status != VXM_OK)
    return status;
  for (size_t i = 0; i < count; i++) {
    const vxm_edge *edge = &caps->edges->edges[loops->edge[begin + i]];
    bool upward = edge->a == loops->vertex[begin + i], mostly_forward = 2 * edge->forward > edge->count;
    caps->steps[i] = (step){loops->vertex[begin + i], upward == mostly_forward ? -1 : 1, false};
  }
  /* the last loop on the stack is cut in two or closed */
  size_t top = 0, length = count;
  size_t sizes[PENDING_MAX], depth = 0, tests = 0;
  for (;;) {
    cut at = {0};
    if (length >= SHORT && depth < PENDING_MAX && tests < TESTS_PER_EDGE * count + TESTS_FREE) {
      double flat = length > LONG ? 0 : flatness(caps, caps->steps + top, length);
      if (flat < NO_SLIT) {
        tests += length + SAMPLES * SAMPLES / 2;
        at = find_cut(caps, caps->steps + top, length, flat < FLAT ? CHORD_PART : SLIT_PART);
      }
    }
    if (at.found) {
      size_t parts[2];
      status = add_chord(caps, caps->steps[top + at.i].from, caps->steps[top + at.j].from, error);
      if (status != VXM_OK)
        return status;
      split(caps->steps, top, length, at, caps->steps + 3 * count, parts);
      sizes[depth++] = parts[0];
      top += parts[0];
      length = parts[1];
      continue;
    }
    status = close_part(caps, caps->steps + top, length, plain && length == count, error);
    if (status != VXM_OK || depth == 0)
      return status;
    length = sizes[--depth];
    top -= length;
  }
}
