/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/loops.h"
#include "mesh/geometry.h"
#include "mesh/sort.h"

#include <stdlib.h>

enum {
  JOIN_MAX = 32 /**< odd edges at a vertex that are joined by angle; beyond, in the order of their fans */
};

/**
 * Odd edge number o has the ends 2 o (at its vertex a) and 2 o + 1 (at b). Every end is joined with another
 * one at the same vertex.
 */
typedef struct builder {
  const vxm_soup *soup;
  const vxm_edges *edges;
  vxm_context *context;
  vxm_error error; /**< of the last allocation that failed */
  size_t odd_count;
  size_t *odd;       /**< place in the edge map */
  size_t *first_end; /**< per vertex: its ends are ends[first_end[v]] to ends[first_end[v + 1] - 1] */
  size_t *ends;
  size_t *partner; /**< per end */
  uint64_t *sides; /**< sorted, unique: vertex << 32 | neighbour, for vertices with more than two odd edges */
  size_t side_count;
  size_t *fan; /**< per side: a union-find forest over the sides of a vertex */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->context, count, size, &b->error);
}

static uint32_t end_vertex(const builder *b, size_t end) {
  const vxm_edge *edge = &b->edges->edges[b->odd[end / 2]];
  return end % 2 ? edge->b : edge->a;
}

static uint32_t far_vertex(const builder *b, size_t end) {
  return end_vertex(b, end ^ 1);
}

static bool is_crossing(const builder *b, uint32_t vertex) {
  return b->first_end[vertex + 1] - b->first_end[vertex] > 2;
}

/* ---- The ends at each vertex ---- */

static bool collect_ends(builder *b) {
  size_t vertices = b->soup->vertex_count;
  b->odd = allocate(b, b->odd_count, sizeof *b->odd);
  b->first_end = allocate(b, vertices + 2, sizeof *b->first_end);
  b->ends = allocate(b, 2 * b->odd_count, sizeof *b->ends);
  b->partner = allocate(b, 2 * b->odd_count, sizeof *b->partner);
  if (!b->odd || !b->first_end || !b->ends || !b->partner)
    return false;
  size_t next = 0;
  for (size_t e = 0; e < b->edges->count; e++)
    if (vxm_edge_is_odd(&b->edges->edges[e]))
      b->odd[next++] = e;
  /* Counted two places on, the sums are the begins, and listing moves each to the next one's begin. */
  for (size_t end = 0; end < 2 * b->odd_count; end++)
    b->first_end[end_vertex(b, end) + 2]++;
  for (size_t v = 2; v < vertices + 2; v++)
    b->first_end[v] += b->first_end[v - 1];
  for (size_t end = 0; end < 2 * b->odd_count; end++)
    b->ends[b->first_end[end_vertex(b, end) + 1]++] = end;
  return true;
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
  while (b->fan[side] != side)
    side = b->fan[side] = b->fan[b->fan[side]];
  return side;
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
  double cosine; /**< of the angle between the edges; less 2 within one fan, so that such pairs come last */
  uint32_t p, q; /**< places among the ends of the vertex */
} candidate;

static int better_first(const void *a, const void *b) {
  const candidate *p = a, *q = b;
  if (p->cosine != q->cosine)
    return p->cosine > q->cosine ? -1 : 1;
  if (p->p != q->p)
    return p->p < q->p ? -1 : 1;
  return p->q < q->q ? -1 : p->q > q->q;
}

static double cosine_between(const builder *b, size_t p, size_t q) {
  const double *at = vxm_position(b->soup, end_vertex(b, p));
  vxm_vec3 u = vxm_vec3_between(vxm_position(b->soup, far_vertex(b, p)), at, 1);
  vxm_vec3 v = vxm_vec3_between(vxm_position(b->soup, far_vertex(b, q)), at, 1);
  double product = vxm_vec3_length(u) * vxm_vec3_length(v);
  double cosine = vxm_vec3_dot(u, v) / product;
  return cosine >= -1 && cosine <= 1 ? cosine : -1; /* also where lengths overflow or vanish */
}

static void join_by_angle(builder *b, const size_t *ends, size_t n) {
  candidate candidates[JOIN_MAX * (JOIN_MAX - 1) / 2];
  size_t fans[JOIN_MAX], count = 0;
  bool joined[JOIN_MAX] = {false};
  for (size_t p = 0; p < n; p++)
    fans[p] = fan_of(b, find_side(b, end_vertex(b, ends[p]), far_vertex(b, ends[p])));
  for (uint32_t p = 0; p < n; p++)
    for (uint32_t q = p + 1; q < n; q++) {
      double penalty = fans[p] == fans[q] ? 2 : 0;
      candidates[count++] = (candidate){cosine_between(b, ends[p], ends[q]) - penalty, p, q};
    }
  qsort(candidates, count, sizeof *candidates, better_first);
  for (size_t c = 0; c < count; c++) {
    if (joined[candidates[c].p] || joined[candidates[c].q])
      continue;
    joined[candidates[c].p] = joined[candidates[c].q] = true;
    join(b, ends[candidates[c].p], ends[candidates[c].q]);
  }
}

static bool join_ends(builder *b) {
  bool crossings = false;
  for (size_t v = 0; v < b->soup->vertex_count && !crossings; v++)
    crossings = is_crossing(b, (uint32_t)v);
  if (crossings && !find_fans(b))
    return false;
  for (size_t v = 0; v < b->soup->vertex_count; v++) {
    const size_t *ends = b->ends + b->first_end[v];
    size_t n = b->first_end[v + 1] - b->first_end[v];
    if (n > 2 && n <= JOIN_MAX)
      join_by_angle(b, ends, n);
    else
      for (size_t i = 0; i + 1 < n; i += 2)
        join(b, ends[i], ends[i + 1]);
  }
  return true;
}

/* ---- Walking ---- */

static bool walk(builder *b, vxm_loops *loops) {
  loops->begin = allocate(b, b->odd_count + 1, sizeof *loops->begin);
  loops->edge = allocate(b, b->odd_count, sizeof *loops->edge);
  loops->vertex = allocate(b, b->odd_count, sizeof *loops->vertex);
  uint8_t *seen = allocate(b, b->odd_count, sizeof *seen);
  if (!loops->begin || !loops->edge || !loops->vertex || !seen) {
    vxm_free(b->context, seen);
    return false;
  }
  size_t step = 0;
  for (size_t o = 0; o < b->odd_count; o++) {
    if (seen[o])
      continue;
    for (size_t end = 2 * o; !seen[end / 2]; end = b->partner[end ^ 1]) {
      seen[end / 2] = 1;
      loops->edge[step] = b->odd[end / 2];
      loops->vertex[step++] = end_vertex(b, end);
    }
    loops->begin[++loops->count] = step;
  }
  vxm_free(b->context, seen);
  return true;
}

vxm_status vxm_loops_build(vxm_loops *out, const vxm_soup *soup, const vxm_edges *edges, vxm_error *error) {
  *out = (vxm_loops){.context = soup->context};
  builder b = {.soup = soup,
               .edges = edges,
               .context = soup->context,
               .error = VXM_ERROR_INIT,
               .odd_count = vxm_edges_count_odd(edges)};
  bool done = collect_ends(&b) && join_ends(&b) && walk(&b, out);
  vxm_free(b.context, b.fan);
  vxm_free(b.context, b.sides);
  vxm_free(b.context, b.partner);
  vxm_free(b.context, b.ends);
  vxm_free(b.context, b.first_end);
  vxm_free(b.context, b.odd);
  if (done)
    return VXM_OK;
  vxm_loops_destroy(out);
  if (error)
    *error = b.error;
  return b.error.code;
}

void vxm_loops_destroy(vxm_loops *loops) {
  vxm_free(loops->context, loops->vertex);
  vxm_free(loops->context, loops->edge);
  vxm_free(loops->context, loops->begin);
  *loops = (vxm_loops){.context = loops->context};
}
