/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/rim_joins.h"
#include "mesh/disjoint_sets.h"
#include "mesh/geometry.h"
#include "mesh/sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  ALL_PAIRS_MAX = 32, /**< odd edges at a vertex of which all pairs are compared */
  WINDOW = 4          /**< beyond, how many neighbours along each axis each one is compared with */
};

typedef vxm_rim_joins builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->context, count, size, &b->error);
}

static uint32_t far_vertex(const builder *b, size_t end) {
  return vxm_rim_vertex_of(b, end ^ 1);
}

static bool is_crossing(const builder *b, uint32_t vertex) {
  return b->first_end[vertex + 1] - b->first_end[vertex] > 2;
}

/* ---- Fans: the faces around a vertex that hang together by their sides ---- */

static uint64_t side_key(uint32_t vertex, uint32_t neighbour) {
  return (uint64_t)vertex << 32 | neighbour;
}

/** Writes (or, with sides NULL, counts) the two sides of every corner at a vertex with more than two odd
 * edges. */
static size_t list_sides(const builder *b, uint64_t *sides) {
  size_t count = 0;
  for (size_t f = 0; f < b->soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    for (size_t c = 0; c < n; c++) {
      if (!is_crossing(b, corner[c]))
        continue;
      if (sides) {
        sides[count] = side_key(corner[c], corner[c ? c - 1 : n - 1]);
        sides[count + 1] = side_key(corner[c], corner[c + 1 < n ? c + 1 : 0]);
      }
      count += 2;
    }
  }
  return count;
}

static int compare_keys(const void *a, const void *b) {
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
  return p < q ? -1 : p > q;
}

static size_t find_side(const builder *b, uint32_t vertex, uint32_t neighbour) {
  uint64_t key = side_key(vertex, neighbour);
  const uint64_t *found = bsearch(&key, b->sides, b->side_count, sizeof key, compare_keys);
  return (size_t)(found - b->sides);
}

static size_t fan_of(const builder *b, size_t side) {
  return vxm_set_of(b->fan, side);
}

static void join_fans(const builder *b) {
  for (size_t f = 0; f < b->soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    for (size_t c = 0; c < n; c++) {
      if (!is_crossing(b, corner[c]))
        continue;
      size_t p = fan_of(b, find_side(b, corner[c], corner[c ? c - 1 : n - 1]));
      size_t q = fan_of(b, find_side(b, corner[c], corner[c + 1 < n ? c + 1 : 0]));
      b->fan[p > q ? p : q] = p < q ? p : q;
    }
  }
}

static bool find_fans(builder *b) {
  size_t count = list_sides(b, NULL);
  b->sides = allocate(b, count, 2 * sizeof *b->sides); /* the second half is scratch of the sort */
  b->fan = allocate(b, count, sizeof *b->fan);
  if (!b->sides || !b->fan)
    return false;
  list_sides(b, b->sides);
  vxm_sort_keys(b->sides, b->sides + count, count);
  for (size_t i = 0; i < count; i++)
    if (i == 0 || b->sides[i] != b->sides[i - 1])
      b->sides[b->side_count++] = b->sides[i];
  for (size_t s = 0; s < b->side_count; s++)
    b->fan[s] = s;
  join_fans(b);
  return true;
}

/* ---- Joining the ends ---- */

static void join(builder *b, size_t p, size_t q) {
  b->partner[p] = q;
  b->partner[q] = p;
}

/** Two ends that could be joined, and how well they go together. */
typedef struct candidate {
  int faults;
  double cosine; /**< of the angle between the edges, in steps of NEAR_ANGLE */
  double rest;   /**< the same of the two other edges, of four */
  bool against;  /**< the faces do not run along both edges one way */
  uint32_t p, q; /**< places among the ends of the vertex, p < q */
} candidate;

/** What speaks against a pair: that the faces do not run along both edges one way, so that no cap could be
 * wound as they are; and, more than that, that both belong to one fan. */
enum { TURNS = 1, OWN_FAN = 2 };

/** Edges whose angle has a greater cosine lie along each other, as at a slit between panels. These go
 * together though each was wound its own way. */
static const double ALONG = 0.999;

/** Angles whose cosines differ by less are as good as equal, so that rounding does not decide. Then, of four
 * edges, those are joined that leave the straightest way to the others: where a wall stands across the rim of
 * an open box, that rim goes on past it, and the wall's own goes round the wall. */
static const double NEAR_ANGLE = 1.0 / 4096;

typedef struct keyed {
  double key;
  uint32_t place; /**< among the ends of the vertex */
} keyed;

/** Scratch for joining the ends at one vertex, with room for the vertex that has the most. */
typedef struct joining {
  const size_t *ends;
  size_t count, candidate_count;
  size_t *grouped; /**< the ends, by owner */
  size_t *fans;    /**< per end */
  uint8_t *joined;
  keyed *sorted;
  candidate *candidates;
} joining;

static int better_first(const void *a, const void *b) {
  const candidate *p = a, *q = b;
  if (p->faults != q->faults)
    return p->faults < q->faults ? -1 : 1;
  if (p->cosine != q->cosine)
    return p->cosine > q->cosine ? -1 : 1;
  if (p->rest != q->rest)
    return p->rest < q->rest ? -1 : 1;
  if (p->against != q->against)
    return p->against ? 1 : -1;
  return vxm_compare_pairs(p->p, p->q, q->p, q->q);
}

static int lower_key_first(const void *a, const void *b) {
  const keyed *p = a, *q = b;
  if (p->key != q->key)
    return p->key < q->key ? -1 : 1;
  return p->place < q->place ? -1 : p->place > q->place;
}

static vxm_vec3 direction_of(const builder *b, size_t end) {
  return vxm_vec3_between(vxm_position(b->soup, far_vertex(b, end)),
                          vxm_position(b->soup, vxm_rim_vertex_of(b, end)), 1);
}

/** Whether most faces of an edge run along it away from the vertex of this end. */
static bool leaves(const builder *b, size_t end) {
  const vxm_edge *edge = &b->edges->edges[b->odd[end / 2].edge];
  return (2 * edge->forward > edge->count) == (vxm_rim_vertex_of(b, end) == edge->a);
}

static void add_candidate(const builder *b, joining *j, uint32_t p, uint32_t q) {
  vxm_vec3 u = direction_of(b, j->ends[p]), v = direction_of(b, j->ends[q]);
  double cosine = vxm_vec3_dot(u, v) / (vxm_vec3_length(u) * vxm_vec3_length(v));
  if (!(cosine >= -1 && cosine <= 1)) /* also where lengths overflow or vanish */
    cosine = cosine > 1 ? 1 : -1;
  bool against = leaves(b, j->ends[p]) == leaves(b, j->ends[q]);
  int faults = (against && cosine < ALONG ? TURNS : 0) + (j->fans[p] == j->fans[q] ? OWN_FAN : 0);
  j->candidates[j->candidate_count++] = (candidate){.faults = faults,
                                                    .cosine = rint(cosine / NEAR_ANGLE),
                                                    .against = against,
                                                    .p = p < q ? p : q,
                                                    .q = p < q ? q : p};
}

static void add_all_candidates(const builder *b, joining *j) {
  for (uint32_t p = 0; p < j->count; p++)
    for (uint32_t q = p + 1; q < j->count; q++)
      add_candidate(b, j, p, q);
  for (size_t c = 0; j->count == 4 && c < j->candidate_count; c++) /* opposite pairs stand mirrored */
    j->candidates[c].rest = j->candidates[j->candidate_count - 1 - c].cosine;
}

/** Those that follow closely on each other along an axis: near directions are near along all of them. */
static void add_near_candidates(const builder *b, joining *j) {
  for (int axis = 0; axis < 3; axis++) {
    for (uint32_t p = 0; p < j->count; p++) {
      vxm_vec3 u = direction_of(b, j->ends[p]);
      double key = (axis == 0 ? u.x : axis == 1 ? u.y : u.z) / vxm_vec3_length(u);
      j->sorted[p] = (keyed){key >= -1 && key <= 1 ? key : 2, p};
    }
    qsort(j->sorted, j->count, sizeof *j->sorted, lower_key_first);
    for (size_t i = 0; i < j->count; i++)
      for (size_t k = i + 1; k < j->count && k <= i + WINDOW; k++)
        add_candidate(b, j, j->sorted[i].place, j->sorted[k].place);
  }
}

/** What is left is joined half way round the fans, so that only a fan that has most of it meets itself. */
static void join_rest(builder *b, joining *j) {
  size_t rest = 0;
  for (uint32_t p = 0; p < j->count; p++)
    if (!j->joined[p])
      j->sorted[rest++] = (keyed){(double)j->fans[p], p};
  qsort(j->sorted, rest, sizeof *j->sorted, lower_key_first);
  for (size_t i = 0; i < rest / 2; i++)
    join(b, j->ends[j->sorted[i].place], j->ends[j->sorted[i + rest / 2].place]);
}

/** Numbers the fans by the first end that each has. */
static void number_fans(const builder *b, joining *j) {
  for (uint32_t p = 0; p < j->count; p++) {
    j->fans[p] = fan_of(b, find_side(b, vxm_rim_vertex_of(b, j->ends[p]), far_vertex(b, j->ends[p])));
    j->sorted[p] = (keyed){(double)j->fans[p], p};
  }
  qsort(j->sorted, j->count, sizeof *j->sorted, lower_key_first);
  for (size_t i = 0, first = 0; i < j->count; i++) {
    first = j->sorted[i].key == j->sorted[first].key ? first : i;
    j->fans[j->sorted[i].place] = j->sorted[first].place;
  }
}

static void join_best(builder *b, joining *j) {
  j->candidate_count = 0;
  memset(j->joined, 0, j->count * sizeof *j->joined);
  number_fans(b, j);
  if (j->count <= ALL_PAIRS_MAX)
    add_all_candidates(b, j);
  else
    add_near_candidates(b, j);
  qsort(j->candidates, j->candidate_count, sizeof *j->candidates, better_first);
  for (size_t c = 0; c < j->candidate_count; c++) {
    uint32_t p = j->candidates[c].p, q = j->candidates[c].q;
    bool own_fan = j->fans[p] == j->fans[q];
    if (j->joined[p] || j->joined[q] || (own_fan && j->count > ALL_PAIRS_MAX))
      continue;
    j->joined[p] = j->joined[q] = 1;
    join(b, j->ends[p], j->ends[q]);
  }
  join_rest(b, j);
}

static size_t most_ends(const builder *b) {
  size_t most = 0;
  for (size_t v = 0; v < b->soup->vertex_count; v++)
    if (b->first_end[v + 1] - b->first_end[v] > most)
      most = b->first_end[v + 1] - b->first_end[v];
  return most;
}

/** Joins the ends at a vertex, those of each owner by themselves. */
static void join_by_owner(builder *b, joining *j, const size_t *ends, size_t count, const uint32_t *owner) {
  for (uint32_t p = 0; p < count; p++)
    j->sorted[p] = (keyed){owner[b->odd[ends[p] / 2].edge], p};
  qsort(j->sorted, count, sizeof *j->sorted, lower_key_first);
  for (size_t i = 0; i < count; i++)
    j->grouped[i] = ends[j->sorted[i].place];
  for (size_t i = 0; i < count; i += j->count) {
    uint32_t whose = owner[b->odd[j->grouped[i] / 2].edge];
    j->ends = j->grouped + i;
    for (j->count = 1; i + j->count < count && owner[b->odd[j->ends[j->count] / 2].edge] == whose;)
      j->count++;
    join_best(b, j);
  }
}

static void join_all(builder *b, joining *j, const uint8_t *at, const uint32_t *owner) {
  for (size_t v = 0; v < b->soup->vertex_count; v++) {
    if (at && !at[v])
      continue;
    j->ends = b->ends + b->first_end[v];
    j->count = b->first_end[v + 1] - b->first_end[v];
    if (j->count > 2 && owner)
      join_by_owner(b, j, j->ends, j->count, owner);
    else if (j->count > 2)
      join_best(b, j);
    else if (j->count == 2)
      join(b, j->ends[0], j->ends[1]);
  }
}

bool vxm_rim_joins_make(vxm_rim_joins *b, const uint8_t *at, const uint32_t *owner) {
  size_t most = most_ends(b), all = ALL_PAIRS_MAX * (ALL_PAIRS_MAX - 1) / 2;
  size_t near = most > ALL_PAIRS_MAX ? 3 * WINDOW * most : 0;
  joining j = {0};
  if (most > 2) {
    if (!b->fan && !find_fans(b))
      return false;
    j.grouped = allocate(b, most, sizeof *j.grouped);
    j.fans = allocate(b, most, sizeof *j.fans);
    j.joined = allocate(b, most, sizeof *j.joined);
    j.sorted = allocate(b, most, sizeof *j.sorted);
    j.candidates = allocate(b, all > near ? all : near, sizeof *j.candidates);
  }
  bool ready = most <= 2 || (j.grouped && j.fans && j.joined && j.sorted && j.candidates);
  if (ready)
    join_all(b, &j, at, owner);
  vxm_free(b->context, j.candidates);
  vxm_free(b->context, j.sorted);
  vxm_free(b->context, j.joined);
  vxm_free(b->context, j.fans);
  vxm_free(b->context, j.grouped);
  return ready;
}

bool vxm_rim_joins_walk(builder *b, vxm_boundary_loops *loops) {
  uint8_t *seen = allocate(b, b->odd_count, sizeof *seen);
  size_t step = 0;
  loops->count = 0;
  for (size_t o = 0; seen && o < b->odd_count; o++) {
    if (seen[o])
      continue;
    for (size_t end = 2 * o; !seen[end / 2]; end = b->partner[end ^ 1]) {
      seen[end / 2] = 1;
      loops->edge[step] = b->odd[end / 2].edge;
      loops->vertex[step++] = vxm_rim_vertex_of(b, end);
    }
    loops->begin[++loops->count] = step;
  }
  vxm_free(b->context, seen);
  return seen != NULL;
}
