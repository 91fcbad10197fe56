/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/edges.h"

#include "base/threads.h"
#include "mesh/radix_partition.h"
#include "mesh/sort.h"

#include <string.h>

/* A side becomes the record (low bits of a, b, direction); the bucket holds the high bits of a. With at least
   two buckets the low bits are 31 at most, so that 31 + 32 + 1 bits fit. Sorting the buckets sorts all. */
enum { DIRECTION_BITS = 1, A_SHIFT = 33 };

typedef struct building {
  const vxm_soup *soup;
  const uint32_t *map;
  unsigned low_bits; /**< bits of a within a bucket */
  vxm_radix_partition buckets;
  uint64_t *scratch; /**< per worker: as many records as the largest bucket has */
  uint32_t *counts;  /**< per worker: see counts_size */
  size_t counts_size;
  size_t *first_edge; /**< per bucket: number of its edges, then place of its first edge */
  vxm_edge *edges;
} building;

/* ---- Collecting ---- */

static inline void put_side(const building *b, vxm_sink *sink, uint32_t from, uint32_t to) {
  if (from == to)
    return;
  uint64_t forward = from < to, low = forward ? from : to, high = forward ? to : from;
  uint64_t mask = (UINT64_C(1) << b->low_bits) - 1;
  vxm_sink_put(sink, (size_t)(low >> b->low_bits),
               (low & mask) << A_SHIFT | high << DIRECTION_BITS | forward);
}

static void emit_sides(size_t begin, size_t end, vxm_sink *sink, void *payload) {
  const building *b = payload;
  const uint32_t *map = b->map;
  for (size_t f = begin; f < end; f++) {
    size_t count;
    const uint32_t *corners = vxm_face(b->soup, f, &count);
    if (count == 3) {
      uint32_t u = corners[0], v = corners[1], w = corners[2];
      if (map)
        u = map[u], v = map[v], w = map[w];
      if (u == v || v == w || w == u)
        continue;
      put_side(b, sink, u, v);
      put_side(b, sink, v, w);
      put_side(b, sink, w, u);
      continue;
    }
    if (!vxm_face_has_three(corners, count, map))
      continue;
    uint32_t last = map ? map[corners[count - 1]] : corners[count - 1];
    for (size_t i = 0; i < count; i++) {
      uint32_t v = map ? map[corners[i]] : corners[i];
      put_side(b, sink, last, v);
      last = v;
    }
  }
}

/* ---- Sorting within a bucket ---- */

/** Counting sort by a, then the few edges of each a by b: less work than sorting all bits. */
static void sort_by_vertex(uint64_t *keys, uint64_t *scratch, uint32_t *counts, size_t vertices,
                           size_t count) {
  memset(counts, 0, (vertices + 1) * sizeof *counts);
  for (size_t i = 0; i < count; i++)
    counts[(keys[i] >> A_SHIFT) + 1]++;
  for (size_t a = 0; a < vertices; a++)
    counts[a + 1] += counts[a];
  for (size_t i = 0; i < count; i++)
    scratch[counts[keys[i] >> A_SHIFT]++] = keys[i];
  /* counts[a] is now where the keys of a end */
  size_t begin = 0;
  for (size_t a = 0; a < vertices; a++) {
    size_t end = counts[a];
    memcpy(keys + begin, scratch + begin, (end - begin) * sizeof *keys);
    vxm_sort_keys(keys + begin, scratch + begin, end - begin);
    begin = end;
  }
}

/** Counting pays if the vertices of a bucket are not many more than its records. */
static bool counting_pays(size_t vertices, size_t records) {
  return vertices <= 4 * records && records <= UINT32_MAX;
}

static void sort_bucket(size_t bucket, int worker, void *payload) {
  building *b = payload;
  size_t begin = b->buckets.begin[bucket], count = b->buckets.begin[bucket + 1] - begin;
  uint64_t *keys = b->buckets.records + begin;
  uint64_t *scratch = b->scratch + (size_t)worker * b->buckets.largest;
  size_t vertices = (size_t)1 << b->low_bits;
  if (counting_pays(vertices, count))
    sort_by_vertex(keys, scratch, b->counts + (size_t)worker * b->counts_size, vertices, count);
  else
    vxm_sort_keys(keys, scratch, count);
  size_t edges = 0;
  for (size_t i = 0; i < count; i++)
    edges += i == 0 || keys[i] >> DIRECTION_BITS != keys[i - 1] >> DIRECTION_BITS;
  b->first_edge[bucket] = edges;
}

/* ---- Writing ---- */

static void write_bucket(size_t bucket, int worker, void *payload) {
  (void)worker;
  building *b = payload;
  const uint64_t *key = b->buckets.records + b->buckets.begin[bucket];
  const uint64_t *end = b->buckets.records + b->buckets.begin[bucket + 1];
  vxm_edge *edge = b->edges + b->first_edge[bucket];
  while (key < end) {
    uint64_t pair = *key >> DIRECTION_BITS;
    *edge = (vxm_edge){.a = (uint32_t)((uint64_t)bucket << b->low_bits | *key >> A_SHIFT),
                       .b = (uint32_t)(*key >> DIRECTION_BITS)};
    for (; key < end && *key >> DIRECTION_BITS == pair; key++) {
      edge->count++;
      edge->forward += (uint32_t)(*key & 1);
    }
    edge++;
  }
}

static vxm_status sort_and_write(building *b, vxm_edges *out, vxm_context *context, vxm_error *error) {
  size_t workers = (size_t)vxm_context_threads(context), vertices = (size_t)1 << b->low_bits;
  b->counts_size = counting_pays(vertices, b->buckets.largest) ? vertices + 1 : 0;
  vxm_error local = VXM_ERROR_INIT;
  b->first_edge = vxm_alloc(context, b->buckets.count, sizeof *b->first_edge, &local);
  if (b->first_edge)
    b->scratch = vxm_alloc(context, workers * b->buckets.largest, sizeof *b->scratch, &local);
  if (b->scratch)
    b->counts = vxm_alloc(context, workers * b->counts_size, sizeof *b->counts, &local);
  bool sorted = b->counts && vxm_parallel_asked(context, b->buckets.count, sort_bucket, b, &local) == VXM_OK;
  if (sorted) {
    size_t total = 0;
    for (size_t i = 0; i < b->buckets.count; i++) {
      size_t count = b->first_edge[i];
      b->first_edge[i] = total;
      total += count;
    }
    out->count = total;
  }
  vxm_free(context, b->counts);
  vxm_free(context, b->scratch);
  if (sorted)
    out->edges = b->edges = vxm_alloc(context, out->count, sizeof *out->edges, &local);
  bool written = b->edges && vxm_parallel_asked(context, b->buckets.count, write_bucket, b, &local) == VXM_OK;
  vxm_free(context, b->first_edge);
  if (written)
    return VXM_OK;
  vxm_free(context, out->edges);
  vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_edges_build(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                           const uint32_t *vertex_map, vxm_error *error) {
  *out = (vxm_edges){.context = context};
  building b = {.soup = soup, .map = vertex_map};
  size_t bucket_count = vxm_radix_partition_advise(soup->corner_count);
  while (soup->vertex_count > bucket_count << b.low_bits)
    b.low_bits++;
  vxm_status status =
      vxm_radix_partition_fill(&b.buckets, context, soup->face_count, bucket_count, emit_sides, &b, error);
  if (status == VXM_OK) {
    status = sort_and_write(&b, out, context, error);
    vxm_radix_partition_free(&b.buckets);
  }
  if (status != VXM_OK)
    *out = (vxm_edges){0};
  return status;
}

void vxm_edges_destroy(vxm_edges *edges) {
  if (!edges->context)
    return;
  vxm_free(edges->context, edges->edges);
  *edges = (vxm_edges){0};
}

/* ---- Asking ---- */

size_t vxm_edges_find(const vxm_edges *edges, uint32_t a, uint32_t b) {
  uint64_t wanted = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
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

size_t vxm_edges_count_odd(const vxm_edges *edges) {
  size_t odd = 0;
  for (size_t e = 0; e < edges->count; e++)
    odd += vxm_edge_is_odd(&edges->edges[e]);
  return odd;
}
