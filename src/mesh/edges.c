/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/edges.h"

#include "base/threads.h"
#include "mesh/face_adjacency.h"
#include "mesh/sort.h"

#include <stdatomic.h>
#include <string.h>

enum { VERTICES_PER_SLICE = 1 << 11 };

typedef struct building {
  vxm_side_table *table;
  size_t slices;
  uint64_t *scratch;  /**< per worker: as many as the largest group has */
  size_t *first_edge; /**< per slice: number of its edges, then place of its first edge */
  vxm_edge *edges;
  uint32_t *sides;
  atomic_size_t odd, open, crowded, against;
} building;

static size_t slice_end(const building *b, size_t slice) {
  size_t begin = slice * VERTICES_PER_SLICE, rest = b->table->vertex_count - begin;
  return begin + (rest < VERTICES_PER_SLICE ? rest : VERTICES_PER_SLICE);
}

/** Takes the sides along the next edge out of a group that is sorted, and numbers them. */
static inline vxm_edge next_edge(const uint64_t *records, vxm_side_group *rest, size_t down, size_t vertex,
                                 uint32_t *sides, uint32_t number) {
  uint32_t up = rest->up < down ? vxm_side_high(records[rest->up]) : UINT32_MAX;
  uint32_t other = rest->down < rest->end ? vxm_side_high(records[rest->down]) : UINT32_MAX;
  vxm_edge edge = {.a = (uint32_t)vertex, .b = up < other ? up : other};
  for (; rest->up < down && vxm_side_high(records[rest->up]) == edge.b; rest->up++, edge.forward++)
    if (sides)
      sides[vxm_side_corner(records[rest->up])] = number;
  edge.count = edge.forward;
  for (; rest->down < rest->end && vxm_side_high(records[rest->down]) == edge.b; rest->down++, edge.count++)
    if (sides)
      sides[vxm_side_corner(records[rest->down])] = number;
  return edge;
}

/** Sorts the sides of each vertex by their other end, and counts the edges. */
static void sort_slice(size_t slice, int worker, void *payload) {
  enum { HIGH = 32 };
  building *b = payload;
  uint64_t *records = b->table->records, *scratch = b->scratch + (size_t)worker * b->table->largest;
  size_t edges = 0;
  for (size_t v = slice * VERTICES_PER_SLICE; v < slice_end(b, slice); v++) {
    vxm_side_group group = vxm_side_group_of(b->table, v);
    vxm_sort_keys_above(records + group.up, scratch, group.down - group.up, HIGH);
    vxm_sort_keys_above(records + group.down, scratch, group.end - group.down, HIGH);
    for (size_t down = group.down; group.up < down || group.down < group.end; edges++)
      next_edge(records, &group, down, v, NULL, 0);
  }
  b->first_edge[slice] = edges;
}

static void write_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  building *b = payload;
  size_t e = b->first_edge[slice], odd = 0, open = 0, crowded = 0, against = 0;
  for (size_t v = slice * VERTICES_PER_SLICE; v < slice_end(b, slice); v++) {
    vxm_side_group group = vxm_side_group_of(b->table, v);
    for (size_t down = group.down; group.up < down || group.down < group.end; e++) {
      vxm_edge edge = next_edge(b->table->records, &group, down, v, b->sides, (uint32_t)e);
      b->edges[e] = edge;
      odd += edge.count & 1;
      open += edge.count == 1;
      crowded += edge.count > 2;
      against += edge.count == 2 && edge.forward != 1;
    }
  }
  atomic_fetch_add_explicit(&b->odd, odd, memory_order_relaxed);
  atomic_fetch_add_explicit(&b->open, open, memory_order_relaxed);
  atomic_fetch_add_explicit(&b->crowded, crowded, memory_order_relaxed);
  atomic_fetch_add_explicit(&b->against, against, memory_order_relaxed);
}

static vxm_status sort_table(building *b, size_t *edges, vxm_context *context, vxm_error *error) {
  size_t workers = (size_t)vxm_context_threads(context);
  b->slices = b->table->vertex_count / VERTICES_PER_SLICE + 1;
  b->first_edge = vxm_alloc(context, b->slices, sizeof *b->first_edge, error);
  if (b->first_edge)
    b->scratch = vxm_alloc(context, workers * b->table->largest, sizeof *b->scratch, error);
  vxm_status status =
      b->scratch ? vxm_parallel_cancellable(context, b->slices, sort_slice, b, error) : error->code;
  vxm_free(context, b->scratch);
  for (size_t i = 0; status == VXM_OK && i < b->slices; i++) {
    size_t count = b->first_edge[i];
    b->first_edge[i] = *edges;
    *edges += count;
  }
  return status;
}

static bool make_room(building *b, size_t edges, size_t corners, vxm_context *context, bool sided,
                      vxm_error *error) {
  b->edges = vxm_alloc(context, edges, sizeof *b->edges, error);
  if (!b->edges || !sided)
    return b->edges != NULL;
  b->sides = vxm_alloc(context, corners, sizeof *b->sides, error);
  if (b->sides && b->table->count < corners)
    memset(b->sides, 0xff, corners * sizeof *b->sides); /* VXM_NO_EDGE */
  return b->sides != NULL;
}

/** Lists the edges of a table. */
static vxm_status list(vxm_edges *out, vxm_side_table *table, size_t corners, bool sided, vxm_error *error) {
  vxm_context *context = out->context;
  building b = {.table = table};
  size_t edges = 0;
  vxm_status status = sort_table(&b, &edges, context, error);
  if (status == VXM_OK)
    status = make_room(&b, edges, corners, context, sided, error)
                 ? vxm_parallel_cancellable(context, b.slices, write_slice, &b, error)
                 : error->code;
  vxm_free(context, b.first_edge);
  *out = (vxm_edges){.context = context,
                     .edges = b.edges,
                     .count = edges,
                     .sides = b.sides,
                     .odd = b.odd,
                     .open = b.open,
                     .crowded = b.crowded,
                     .against = b.against};
  return status;
}

/** What is to be made of a soup. */
typedef enum content { EDGES, EDGES_AND_SIDES, PAIRS_OR_SIDES } content;

static vxm_status run(vxm_edges *out, content wanted, vxm_context *context, const vxm_soup *soup,
                      const uint32_t *vertex_map, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_side_table table;
  *out = (vxm_edges){.context = context};
  vxm_status status = vxm_side_table_build(&table, context, soup, vertex_map, &local);
  if (status == VXM_OK && wanted == PAIRS_OR_SIDES)
    status = vxm_face_adjacency_build(&out->adjacent, &table, soup, &local);
  if (out->adjacent)
    out->count = table.count / 2;
  else if (status == VXM_OK)
    status = list(out, &table, soup->corner_count, wanted != EDGES, &local);
  vxm_side_table_destroy(&table);
  if (status != VXM_OK) {
    vxm_edges_destroy(out);
    vxm_error_pass(error, &local);
  }
  return status;
}

vxm_status vxm_edges_build(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                           const uint32_t *vertex_map, vxm_error *error) {
  return run(out, EDGES, context, soup, vertex_map, error);
}

vxm_status vxm_edges_build_sides(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                                 const uint32_t *vertex_map, vxm_error *error) {
  return run(out, EDGES_AND_SIDES, context, soup, vertex_map, error);
}

vxm_status vxm_edges_build_pairs(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                                 vxm_error *error) {
  return run(out, PAIRS_OR_SIDES, context, soup, NULL, error);
}

void vxm_edges_destroy(vxm_edges *edges) {
  if (!edges->context)
    return;
  vxm_free(edges->context, edges->adjacent);
  vxm_free(edges->context, edges->sides);
  vxm_free(edges->context, edges->edges);
  *edges = (vxm_edges){0};
}

/* ---- Asking ---- */

size_t vxm_edges_find(const vxm_edges *edges, uint32_t a, uint32_t b) {
  uint64_t wanted = vxm_edge_key(a, b);
  size_t low = 0, high = edges->count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    uint64_t key = (uint64_t)edges->edges[middle].a << 32 | edges->edges[middle].b;
    if (key < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  bool found = low < edges->count && edges->edges[low].a == (uint32_t)(wanted >> 32) &&
               edges->edges[low].b == (uint32_t)wanted;
  return found ? low : edges->count;
}
