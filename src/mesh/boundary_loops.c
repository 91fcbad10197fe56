/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/boundary_loops.h"
#include "mesh/geometry.h"
#include "mesh/sort.h"
#include "mesh/touching_bodies.h"

#include <stdlib.h>
#include <string.h>

typedef vxm_rim_joins builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->context, count, size, &b->error);
}

/* ---- Odd edges in an order of space ---- */

/** A vertex that an odd edge has. */
typedef struct located {
  double at[3];
  uint32_t vertex;
} located;

static int lower_position_first(const void *a, const void *b) {
  const located *p = a, *q = b;
  if (vxm_lies_before(p->at, q->at) || vxm_lies_before(q->at, p->at))
    return vxm_lies_before(p->at, q->at) ? -1 : 1;
  return p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

static int earlier_ends_first(const void *a, const void *b) {
  const vxm_odd_edge *p = a, *q = b;
  return vxm_compare_pairs(p->first, p->other, q->first, q->other);
}

/** Lists the vertices of odd edges once each, and marks them in `rank`; returns how many there are. */
static size_t list_vertices(const builder *b, located *list, uint32_t *rank) {
  size_t count = 0;
  for (size_t o = 0; o < b->odd_count; o++) {
    const vxm_edge *edge = &b->edges->edges[b->odd[o].edge];
    const uint32_t ends[2] = {edge->a, edge->b};
    for (int i = 0; i < 2; i++) {
      if (rank[ends[i]]++ > 0)
        continue;
      const double *p = vxm_position(b->soup, ends[i]);
      list[count++] = (located){{p[0], p[1], p[2]}, ends[i]};
    }
  }
  return count;
}

/** Sorts the odd edges, and puts first the end of each that comes first. */
static void sort_odd(builder *b, located *list, uint32_t *rank) {
  size_t count = list_vertices(b, list, rank);
  qsort(list, count, sizeof *list, lower_position_first);
  for (size_t i = 0; i < count; i++)
    rank[list[i].vertex] = (uint32_t)i;
  for (size_t o = 0; o < b->odd_count; o++) {
    const vxm_edge *edge = &b->edges->edges[b->odd[o].edge];
    uint32_t p = rank[edge->a], q = rank[edge->b];
    b->odd[o].first = p < q ? p : q;
    b->odd[o].other = p < q ? q : p;
  }
  qsort(b->odd, b->odd_count, sizeof *b->odd, earlier_ends_first);
  for (size_t o = 0; o < b->odd_count; o++) {
    b->odd[o].first = list[b->odd[o].first].vertex;
    b->odd[o].other = list[b->odd[o].other].vertex;
  }
}

static bool find_odd(builder *b) {
  b->odd = allocate(b, b->odd_count, sizeof *b->odd);
  located *list = b->odd ? allocate(b, 2 * b->odd_count, sizeof *list) : NULL;
  uint32_t *rank = list ? allocate(b, b->soup->vertex_count, sizeof *rank) : NULL;
  size_t next = 0;
  for (size_t e = 0; rank && e < b->edges->count; e++)
    if (vxm_edge_is_odd(&b->edges->edges[e]))
      b->odd[next++].edge = e;
  if (rank)
    sort_odd(b, list, rank);
  vxm_free(b->context, rank);
  vxm_free(b->context, list);
  return rank != NULL;
}

/* ---- The ends at each vertex ---- */

static bool collect_ends(builder *b) {
  size_t vertices = b->soup->vertex_count;
  b->first_end = allocate(b, vertices + 2, sizeof *b->first_end);
  b->ends = allocate(b, 2 * b->odd_count, sizeof *b->ends);
  b->partner = allocate(b, 2 * b->odd_count, sizeof *b->partner);
  if (!b->first_end || !b->ends || !b->partner)
    return false;
  /* Counted two places on, the sums are the begins, and listing moves each to the next one's begin. */
  for (size_t end = 0; end < 2 * b->odd_count; end++)
    b->first_end[vxm_rim_vertex_of(b, end) + 2]++;
  for (size_t v = 2; v < vertices + 2; v++)
    b->first_end[v] += b->first_end[v - 1];
  for (size_t end = 0; end < 2 * b->odd_count; end++)
    b->ends[b->first_end[vxm_rim_vertex_of(b, end) + 1]++] = end;
  return true;
}

/* ---- Walking ---- */

static bool make_room(builder *b, vxm_boundary_loops *loops) {
  loops->begin = allocate(b, b->odd_count + 1, sizeof *loops->begin);
  loops->edge = allocate(b, b->odd_count, sizeof *loops->edge);
  loops->vertex = allocate(b, b->odd_count, sizeof *loops->vertex);
  return loops->begin && loops->edge && loops->vertex;
}

vxm_status vxm_boundary_loops_build(vxm_boundary_loops *out, const vxm_soup *soup, const vxm_edges *edges,
                                    vxm_error *error) {
  *out = (vxm_boundary_loops){.context = soup->context};
  builder b = {.soup = soup,
               .edges = edges,
               .context = soup->context,
               .error = VXM_ERROR_INIT,
               .odd_count = edges->odd};
  bool done = find_odd(&b) && collect_ends(&b) && vxm_rim_joins_make(&b, NULL, NULL) && make_room(&b, out) &&
              vxm_rim_joins_walk(&b, out) && vxm_touching_bodies_part(&b, out);
  vxm_free(b.context, b.fan);
  vxm_free(b.context, b.sides);
  vxm_free(b.context, b.partner);
  vxm_free(b.context, b.ends);
  vxm_free(b.context, b.first_end);
  vxm_free(b.context, b.odd);
  if (done)
    return VXM_OK;
  vxm_boundary_loops_destroy(out);
  vxm_error_pass(error, &b.error);
  return b.error.code;
}

void vxm_boundary_loops_destroy(vxm_boundary_loops *loops) {
  vxm_free(loops->context, loops->vertex);
  vxm_free(loops->context, loops->edge);
  vxm_free(loops->context, loops->begin);
  *loops = (vxm_boundary_loops){.context = loops->context};
}
