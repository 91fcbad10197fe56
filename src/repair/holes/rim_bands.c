/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/holes/rim_bands.h"

#include "mesh/geometry.h"
#include "mesh/sort.h"
#include "repair/holes/cap_plan.h"

#include <stdlib.h>

/** Of the area of a band that lies in a plane without folds, its vector area is at least this part; and of
 * one that is flat enough to take where it is narrow. */
static const double PLANE = 1 - 1e-6, FLAT = 0.5;
/** The mean cosine between a band's normal and the ways into the faces at a rim: at most this. */
static const double BEHIND = -0.2;
/** Rims that each one is compared with. */
enum { TRIES = 64 };

/** A loop that passes no vertex twice, as its cap runs: against the faces at it. */
typedef struct rim {
  size_t loop, begin, count;
  bool backward; /**< the steps run along the faces */
  vxm_vec3 area; /**< vector area of its cap */
  vxm_vec3 into; /**< sum over the edges: the way into the face, times the length */
  double length;
  double lo[3], hi[3];
} rim;

/** A strip between two rims. */
typedef struct band {
  size_t first, second; /**< places among the rims */
  double area;
} band;

typedef struct joining {
  vxm_cap_plan plan;
  rim *rims;
  size_t rim_count;
  band *bands;
  size_t band_count, band_capacity;
  uint32_t (*triangles)[3]; /**< scratch, of one band */
  size_t triangle_capacity;
  size_t *partner; /**< per loop: one more than the place of its band, or 0 */
} joining;

static uint32_t vertex_of(const joining *j, const rim *r, size_t step) {
  size_t k = step % r->count;
  return j->plan.loops.vertex[r->begin + (r->backward ? r->count - 1 - k : k)];
}

static vxm_vec3 between(const joining *j, uint32_t p, uint32_t q) {
  return vxm_vec3_between(vxm_position(j->plan.soup, p), vxm_position(j->plan.soup, q), j->plan.scale);
}

static vxm_vec3 plus(vxm_vec3 a, vxm_vec3 b, double share) {
  return (vxm_vec3){a.x + share * b.x, a.y + share * b.y, a.z + share * b.z};
}

/* ---- Rims ---- */

/** From an edge of the rim into its face, as long as the edge. */
static vxm_vec3 way_into(const joining *j, size_t face, uint32_t from, uint32_t to) {
  size_t count;
  const uint32_t *corner = vxm_face(j->plan.soup, face, &count);
  vxm_vec3 normal = vxm_polygon_area(j->plan.soup->positions, corner, count, j->plan.scale);
  double length = vxm_vec3_length(normal);
  vxm_vec3 into = vxm_vec3_cross(between(j, to, from), normal); /* the face runs against the rim */
  return length > 0 ? (vxm_vec3){into.x / length, into.y / length, into.z / length} : (vxm_vec3){0, 0, 0};
}

static void measure(const joining *j, rim *r) {
  uint32_t origin = vertex_of(j, r, 0);
  for (int a = 0; a < 3; a++)
    r->lo[a] = r->hi[a] = vxm_position(j->plan.soup, origin)[a];
  for (size_t i = 0; i < r->count; i++) {
    uint32_t from = vertex_of(j, r, i), to = vertex_of(j, r, i + 1);
    size_t step = r->backward ? (2 * r->count - 2 - i) % r->count : i;
    size_t face = j->plan.edge_face[j->plan.loops.edge[r->begin + step]];
    r->area = plus(r->area, vxm_vec3_cross(between(j, from, origin), between(j, to, origin)), 0.5);
    r->into = plus(r->into, way_into(j, face, from, to), 1);
    r->length += vxm_vec3_length(between(j, to, from));
    for (int a = 0; a < 3; a++) {
      double x = vxm_position(j->plan.soup, from)[a];
      r->lo[a] = x < r->lo[a] ? x : r->lo[a];
      r->hi[a] = x > r->hi[a] ? x : r->hi[a];
    }
  }
}

/** Whether the steps of a plain loop run along its faces. */
static bool runs_along(const joining *j, size_t loop) {
  size_t step = j->plan.loops.begin[loop];
  const vxm_edge *edge = &j->plan.state->edges.edges[j->plan.loops.edge[step]];
  return (edge->a == j->plan.loops.vertex[step]) == (edge->forward == 1);
}

static int by_place(const void *a, const void *b) {
  const rim *p = a, *q = b;
  if (p->lo[0] != q->lo[0])
    return p->lo[0] < q->lo[0] ? -1 : 1;
  return p->loop < q->loop ? -1 : p->loop > q->loop;
}

/** Lists the loops that may be joined, from left to right. */
static bool find_rims(joining *j) {
  vxm_cap_plan *p = &j->plan;
  uint8_t *passes = vxm_cap_plan_allocate(p, p->soup->vertex_count, sizeof *passes);
  j->rims = vxm_cap_plan_allocate(p, p->loops.count, sizeof *j->rims);
  for (size_t s = 0; passes && s < p->loops.begin[p->loops.count]; s++) {
    uint8_t *at = &passes[p->loops.vertex[s]];
    *at = *at ? 2 : 1;
  }
  for (size_t l = 0; passes && j->rims && l < p->loops.count; l++) {
    rim r = {.loop = l, .begin = p->loops.begin[l], .count = vxm_cap_plan_edges(p, l)};
    bool fits = r.count >= 3 && r.count <= p->most && vxm_cap_plan_is_plain(p, l);
    for (size_t i = 0; fits && i < r.count; i++)
      fits = passes[p->loops.vertex[r.begin + i]] == 1;
    if (!fits)
      continue;
    r.backward = runs_along(j, l);
    measure(j, &r);
    j->rims[j->rim_count++] = r;
  }
  vxm_free(p->state->context, passes);
  if (j->rims)
    qsort(j->rims, j->rim_count, sizeof *j->rims, by_place);
  return passes && j->rims;
}

/* ---- Bands ---- */

/** Puts a triangle and adds its area. */
static void put(joining *j, size_t at, uint32_t a, uint32_t b, uint32_t c, double *area, vxm_vec3 *sum) {
  vxm_vec3 cross = vxm_vec3_cross(between(j, b, a), between(j, c, a));
  j->triangles[at][0] = a;
  j->triangles[at][1] = b;
  j->triangles[at][2] = c;
  *area += 0.5 * vxm_vec3_length(cross);
  *sum = plus(*sum, cross, 0.5);
}

/** The step of `r`, backward, whose vertex is nearest to one. */
static size_t nearest(const joining *j, const rim *r, uint32_t vertex) {
  size_t best = 0;
  for (size_t k = 1; k < r->count; k++)
    if (vxm_vec3_length(between(j, vertex_of(j, r, r->count - k), vertex)) <
        vxm_vec3_length(between(j, vertex_of(j, r, r->count - best), vertex)))
      best = k;
  return best;
}

static bool has_edge(const joining *j, uint32_t p, uint32_t q) {
  return p == q || vxm_edges_find(&j->plan.state->edges, p, q) < j->plan.state->edges.count;
}

/** Makes the triangles from one rim to another, which runs the other way: on along that which leaves the
 * shorter rung. False where a rung is there as an edge already. */
static bool zip(joining *j, const rim *r, const rim *s, double *area, vxm_vec3 *sum) {
  size_t i = 0, k = 0, start = nearest(j, s, vertex_of(j, r, 0)), done = 0;
  *area = 0;
  *sum = (vxm_vec3){0, 0, 0};
  while (i < r->count || k < s->count) {
    uint32_t a = vertex_of(j, r, i), next_a = vertex_of(j, r, i + 1);
    uint32_t b = vertex_of(j, s, 2 * s->count - (start + k)),
             next_b = vertex_of(j, s, 2 * s->count - (start + k + 1));
    bool on_first = k == s->count || (i < r->count && vxm_vec3_length(between(j, next_a, b)) <=
                                                          vxm_vec3_length(between(j, a, next_b)));
    if (has_edge(j, a, b))
      return false;
    if (on_first)
      put(j, done++, a, next_a, b, area, sum);
    else
      put(j, done++, next_b, b, a, area, sum);
    i += on_first;
    k += !on_first;
  }
  return true;
}

static bool is_behind(const rim *r, vxm_vec3 normal) {
  return vxm_vec3_dot(r->into, normal) <= BEHIND * r->length * vxm_vec3_length(normal);
}

/** Whether a rim lies in the box of another one, or beside it by a small part of its size. */
static bool is_inside(const rim *r, const rim *s) {
  double slack = 0;
  for (int a = 0; a < 3; a++)
    slack += (s->hi[a] - s->lo[a]) / 10;
  for (int a = 0; a < 3; a++)
    if (!(r->lo[a] >= s->lo[a] - slack && r->hi[a] <= s->hi[a] + slack))
      return false;
  return true;
}

/** What can be told without the band: caps that face each other, of which the larger one lies around. */
static bool may_join(const rim *r, const rim *s) {
  vxm_vec3 both = vxm_vec3_sum(r->area, s->area);
  double p = vxm_vec3_length(r->area), q = vxm_vec3_length(s->area);
  return vxm_vec3_dot(r->area, s->area) <= -FLAT * p * q && (p < q ? is_inside(r, s) : is_inside(s, r)) &&
         is_behind(r, both) && is_behind(s, both);
}

static bool grow_triangles(joining *j, size_t count) {
  void *triangles = j->triangles;
  bool grown = vxm_grow(j->plan.state->context, &triangles, &j->triangle_capacity, count,
                        sizeof *j->triangles, &j->plan.error) == VXM_OK;
  j->triangles = triangles;
  return grown;
}

/** Looks at the band between two rims, and lists it if it is one. */
static bool try_pair(joining *j, size_t first, size_t second) {
  const rim *r = &j->rims[first], *s = &j->rims[second];
  double area;
  vxm_vec3 sum;
  if (!grow_triangles(j, r->count + s->count))
    return false;
  if (!zip(j, r, s, &area, &sum))
    return true;
  double flat = vxm_vec3_length(sum), p = vxm_vec3_length(r->area), q = vxm_vec3_length(s->area);
  bool narrow = area < (p < q ? p : q);
  if (!(flat > 0) || !(flat >= (narrow ? FLAT : PLANE) * area) || !is_behind(r, sum) || !is_behind(s, sum))
    return true;
  void *bands = j->bands;
  if (vxm_grow(j->plan.state->context, &bands, &j->band_capacity, j->band_count + 1, sizeof *j->bands,
               &j->plan.error) != VXM_OK)
    return false;
  j->bands = bands;
  j->bands[j->band_count++] = (band){first, second, area};
  return true;
}

static int smaller_first(const void *a, const void *b) {
  const band *p = a, *q = b;
  if (p->area != q->area)
    return p->area < q->area ? -1 : 1;
  return vxm_compare_pairs(p->first, p->second, q->first, q->second);
}

static bool find_bands(joining *j) {
  vxm_context *context = j->plan.state->context;
  for (size_t r = 0; r < j->rim_count; r++) {
    if (vxm_check_cancelled_at(r, context, &j->plan.error) != VXM_OK)
      return false;
    for (size_t s = r + 1; s < j->rim_count && s <= r + TRIES; s++)
      if (may_join(&j->rims[r], &j->rims[s]) && !try_pair(j, r, s))
        return false;
  }
  if (j->band_count > 0)
    qsort(j->bands, j->band_count, sizeof *j->bands, smaller_first);
  return true;
}

/* ---- Closing ---- */

/** Takes each rim for the smallest band it has part in, if the other one has none smaller. */
static bool choose(joining *j) {
  j->partner = vxm_cap_plan_allocate(&j->plan, j->plan.loops.count, sizeof *j->partner);
  for (size_t b = 0; j->partner && b < j->band_count; b++) {
    size_t loops[2] = {j->rims[j->bands[b].first].loop, j->rims[j->bands[b].second].loop};
    if (j->partner[loops[0]] == 0 && j->partner[loops[1]] == 0)
      j->partner[loops[0]] = j->partner[loops[1]] = b + 1;
  }
  return j->partner != NULL;
}

/** A band goes with the first of its loops; the other one is closed by it as well. */
static bool plan_bands(joining *j) {
  vxm_cap_plan *p = &j->plan;
  uint8_t *done = vxm_cap_plan_allocate(p, j->band_count, sizeof *done);
  bool ready = done != NULL;
  for (size_t l = 0; ready && l < p->loops.count; l++) {
    size_t number = j->partner[l];
    p->wanted[l] = number > 0;
    if (number > 0 && !done[number - 1]) {
      const rim *r = &j->rims[j->bands[number - 1].first], *s = &j->rims[j->bands[number - 1].second];
      double area;
      vxm_vec3 sum;
      done[number - 1] = 1;
      zip(j, r, s, &area, &sum);
      ready = vxm_cap_plan_take(p, (const uint32_t(*)[3])j->triangles, r->count + s->count);
    }
    vxm_cap_plan_pass(p, l);
  }
  vxm_free(p->state->context, done);
  return ready;
}

vxm_status vxm_fill_bands(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error) {
  joining j = {.rims = NULL};
  int64_t count = -1;
  if (vxm_cap_plan_begin(&j.plan, state, most) && find_rims(&j) && find_bands(&j)) {
    bool ready = j.band_count == 0 || (choose(&j) && plan_bands(&j));
    count = !ready ? -1 : j.band_count > 0 ? vxm_cap_plan_close(&j.plan) : 0;
  }
  *closed = count < 0 ? 0 : count;
  vxm_free(state->context, j.partner);
  vxm_free(state->context, j.triangles);
  vxm_free(state->context, j.bands);
  vxm_free(state->context, j.rims);
  return vxm_cap_plan_end(&j.plan, count >= 0, error);
}
