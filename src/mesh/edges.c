/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/edges.h"

#include "base/threads.h"
#include "mesh/radix_partition.h"
#include "mesh/sort.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <string.h>

/* A side becomes the record (low bits of a, corner at which b is, mark, direction); the bucket holds the high
   bits of a. From the corner follow b and, as the direction is known, the corner at which the side begins.
   Sorting the buckets sorts all. 2^40 corners would take more memory than machines have. */
enum {
  FORWARD = 1, /**< from a to b */
  FIRST = 2,   /**< once sorted: of the sides along its edge */
  CORNER_SHIFT = 2,
  A_SHIFT = 42,
  A_BITS = 64 - A_SHIFT
};

typedef struct building {
  const vxm_soup *soup;
  const uint32_t *map;
  uint64_t *before;  /**< per corner: the one before it around the face; NULL = all faces are triangles */
  unsigned low_bits; /**< bits of a within a bucket */
  vxm_radix_partition buckets;
  uint64_t *scratch; /**< per worker: three times as many records as the largest bucket has */
  uint32_t *counts;  /**< per worker: see counts_size */
  size_t counts_size;
  size_t *first_edge; /**< per bucket: number of its edges, then place of its first edge */
  vxm_edge *edges;
  uint32_t *sides;
  atomic_size_t odd, open, crowded, against;
} building;

static inline uint32_t vertex_at(const building *b, size_t corner) {
  uint32_t v = b->soup->indices[corner];
  return b->map ? b->map[v] : v;
}

static inline size_t corner_of(uint64_t record) {
  return (size_t)(record >> CORNER_SHIFT & ((UINT64_C(1) << (A_SHIFT - CORNER_SHIFT)) - 1));
}

/* ---- Collecting ---- */

/** Without a branch on the direction, which nobody can tell. */
static inline void put_side(const building *b, vxm_sink *sink, uint32_t from, uint32_t to, size_t from_corner,
                            size_t to_corner) {
  uint64_t forward = from < to, low = from < to ? from : to;
  uint64_t corner = from_corner + (-forward & (to_corner - from_corner));
  uint64_t mask = (UINT64_C(1) << b->low_bits) - 1;
  vxm_sink_put(sink, (size_t)(low >> b->low_bits),
               (low & mask) << A_SHIFT | corner << CORNER_SHIFT | forward);
}

static void emit_sides(size_t begin, size_t end, vxm_sink *out, void *payload) {
  const building *b = payload;
  vxm_sink own = *out, *sink = &own; /* which no other store can change */
  for (size_t f = begin; f < end; f++) {
    size_t count, first = (size_t)b->soup->offsets[f];
    const uint32_t *corners = vxm_face(b->soup, f, &count);
    if (count == 3) {
      uint32_t u = vertex_at(b, first), v = vertex_at(b, first + 1), w = vertex_at(b, first + 2);
      if (u == v || v == w || w == u)
        continue;
      put_side(b, sink, u, v, first, first + 1);
      put_side(b, sink, v, w, first + 1, first + 2);
      put_side(b, sink, w, u, first + 2, first);
      continue;
    }
    if (!vxm_face_has_three(corners, count, b->map))
      continue;
    for (size_t i = 0, last = first + count - 1; i < count; last = first + i++)
      if (vertex_at(b, last) != vertex_at(b, first + i))
        put_side(b, sink, vertex_at(b, last), vertex_at(b, first + i), last, first + i);
  }
}

/* ---- Sorting within a bucket ---- */

/** A key is b and the place of the record in its bucket. All are looked up in one go, as they lie here and
 * there. */
static inline uint64_t key_of(const building *b, const uint64_t *records, size_t i) {
  return (uint64_t)vertex_at(b, corner_of(records[i])) << 32 | i;
}

/** Counting sort by a: less work than sorting all bits. */
static void group_by_counting(const building *b, const uint64_t *records, size_t count, uint64_t *keys,
                              uint32_t *counts) {
  size_t vertices = (size_t)1 << b->low_bits;
  memset(counts, 0, (vertices + 1) * sizeof *counts);
  for (size_t i = 0; i < count; i++)
    counts[(records[i] >> A_SHIFT) + 1]++;
  for (size_t a = 0; a < vertices; a++)
    counts[a + 1] += counts[a];
  for (size_t i = 0; i < count; i++)
    keys[counts[records[i] >> A_SHIFT]++] = key_of(b, records, i);
}

static void group_by_sorting(const building *b, const uint64_t *records, size_t count, uint64_t *keys,
                             uint64_t *scratch) {
  for (size_t i = 0; i < count; i++)
    keys[i] = records[i] >> A_SHIFT << 32 | i;
  vxm_sort_keys(keys, scratch, count);
  for (size_t i = 0; i < count; i++)
    keys[i] = key_of(b, records, (uint32_t)keys[i]);
}

/** Counting pays if the vertices of a bucket are not many more than its records. */
static bool counting_pays(size_t vertices, size_t records) {
  return vertices <= 4 * records;
}

/** Puts the few sides of one a in the order of b, and marks the first of each edge. Returns how many edges
 * there are. */
static size_t sort_sides(const uint64_t *records, uint64_t *keys, size_t count, uint64_t *scratch,
                         uint64_t *sorted) {
  vxm_sort_keys(keys, scratch, count);
  size_t edges = 0;
  for (size_t i = 0; i < count; i++) {
    bool first = i == 0 || keys[i] >> 32 != keys[i - 1] >> 32;
    sorted[i] = records[(uint32_t)keys[i]] | (first ? FIRST : 0);
    edges += first;
  }
  return edges;
}

static void sort_bucket(size_t bucket, int worker, void *payload) {
  building *b = payload;
  size_t begin = b->buckets.begin[bucket], count = b->buckets.begin[bucket + 1] - begin;
  size_t largest = b->buckets.largest, edges = 0;
  uint64_t *records = b->buckets.records + begin;
  uint64_t *keys = b->scratch + (size_t)worker * 3 * largest, *scratch = keys + largest,
           *sorted = scratch + largest;
  if (counting_pays((size_t)1 << b->low_bits, count))
    group_by_counting(b, records, count, keys, b->counts + (size_t)worker * b->counts_size);
  else
    group_by_sorting(b, records, count, keys, scratch);
  for (size_t i = 0, end; i < count; i = end) {
    uint64_t a = records[(uint32_t)keys[i]] >> A_SHIFT;
    for (end = i + 1; end < count && records[(uint32_t)keys[end]] >> A_SHIFT == a;)
      end++;
    edges += sort_sides(records, keys + i, end - i, scratch, sorted + i);
  }
  if (count > 0)
    memcpy(records, sorted, count * sizeof *records);
  b->first_edge[bucket] = edges;
}

/* ---- Writing ---- */

/** The corner at which a side begins. */
static inline size_t side_of(const building *b, uint64_t record) {
  size_t corner = corner_of(record);
  if (!(record & FORWARD))
    return corner;
  return b->before ? b->before[corner] : corner % 3 == 0 ? corner + 2 : corner - 1;
}

/** Fetches what will be needed soon, which lies here and there. */
static inline void look_ahead(const building *b, const uint64_t *record, const uint64_t *end) {
  enum { AHEAD = 16 };
  if (end - record <= AHEAD)
    return;
  __builtin_prefetch(b->soup->indices + corner_of(record[AHEAD]));
  if (b->sides) {
    __builtin_prefetch(b->sides + corner_of(record[AHEAD - 1]), 1);
    __builtin_prefetch(b->sides + corner_of(record[AHEAD]), 1);
  }
}

static void write_bucket(size_t bucket, int worker, void *payload) {
  (void)worker;
  building *b = payload;
  const uint64_t *record = b->buckets.records + b->buckets.begin[bucket];
  const uint64_t *end = b->buckets.records + b->buckets.begin[bucket + 1];
  size_t odd = 0, open = 0, crowded = 0, against = 0;
  for (size_t e = b->first_edge[bucket]; record < end; e++) {
    look_ahead(b, record, end);
    vxm_edge edge = {.a = (uint32_t)((uint64_t)bucket << b->low_bits | *record >> A_SHIFT),
                     .b = vertex_at(b, corner_of(*record))};
    do {
      edge.count++;
      edge.forward += (uint32_t)(*record & FORWARD);
      if (b->sides)
        b->sides[side_of(b, *record)] = (uint32_t)e;
    } while (++record < end && !(*record & FIRST));
    b->edges[e] = edge;
    odd += edge.count & 1;
    open += edge.count == 1;
    crowded += edge.count > 2;
    against += edge.count == 2 && edge.forward != 1;
  }
  atomic_fetch_add_explicit(&b->odd, odd, memory_order_relaxed);
  atomic_fetch_add_explicit(&b->open, open, memory_order_relaxed);
  atomic_fetch_add_explicit(&b->crowded, crowded, memory_order_relaxed);
  atomic_fetch_add_explicit(&b->against, against, memory_order_relaxed);
}

/* ---- All together ---- */

static vxm_status sort_buckets(building *b, size_t *edges, vxm_context *context, vxm_error *error) {
  size_t workers = (size_t)vxm_context_threads(context), vertices = (size_t)1 << b->low_bits;
  if (b->buckets.largest > UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu sides of faces at a few vertices; split the mesh",
                    b->buckets.largest);
  b->counts_size = counting_pays(vertices, b->buckets.largest) ? vertices + 1 : 0;
  b->scratch = vxm_alloc(context, workers * b->buckets.largest, 3 * sizeof *b->scratch, error);
  if (b->scratch)
    b->counts = vxm_alloc(context, workers * b->counts_size, sizeof *b->counts, error);
  vxm_status status =
      b->counts ? vxm_parallel_asked(context, b->buckets.count, sort_bucket, b, error) : VXM_ERROR_MEMORY;
  vxm_free(context, b->counts);
  vxm_free(context, b->scratch);
  for (size_t i = 0; status == VXM_OK && i < b->buckets.count; i++) {
    size_t count = b->first_edge[i];
    b->first_edge[i] = *edges;
    *edges += count;
  }
  return status;
}

/** For soups with polygons: what comes before a corner. */
static bool list_before(building *b, vxm_context *context, vxm_error *error) {
  const vxm_soup *soup = b->soup;
  size_t f = 0;
  while (f < soup->face_count && soup->offsets[f + 1] - soup->offsets[f] == 3)
    f++;
  if (f == soup->face_count)
    return true;
  b->before = vxm_alloc(context, soup->corner_count, sizeof *b->before, error);
  for (f = 0; b->before && f < soup->face_count; f++)
    for (uint64_t c = soup->offsets[f], last = soup->offsets[f + 1] - 1; c < soup->offsets[f + 1]; last = c++)
      b->before[c] = last;
  return b->before != NULL;
}

static bool make_room(building *b, size_t edges, bool sided, vxm_context *context, vxm_error *error) {
  b->edges = vxm_alloc(context, edges, sizeof *b->edges, error);
  if (!b->edges || !sided)
    return b->edges != NULL;
  if (edges >= VXM_NO_EDGE)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu edges are too many to number; split the mesh", edges), false;
  b->sides = vxm_alloc(context, b->soup->corner_count, sizeof *b->sides, error);
  if (b->sides && b->buckets.begin[b->buckets.count] < b->soup->corner_count)
    memset(b->sides, 0xff, b->soup->corner_count * sizeof *b->sides); /* VXM_NO_EDGE */
  return b->sides && list_before(b, context, error);
}

static vxm_status build(building *b, size_t *edges, bool sided, vxm_context *context, vxm_error *error) {
  b->first_edge = vxm_alloc(context, b->buckets.count, sizeof *b->first_edge, error);
  if (!b->first_edge || sort_buckets(b, edges, context, error) != VXM_OK ||
      !make_room(b, *edges, sided, context, error))
    return error->code;
  return vxm_parallel_asked(context, b->buckets.count, write_bucket, b, error);
}

static vxm_status run(vxm_edges *out, bool sided, vxm_context *context, const vxm_soup *soup,
                      const uint32_t *vertex_map, vxm_error *error) {
  *out = (vxm_edges){.context = context};
  vxm_error local = VXM_ERROR_INIT;
  building b = {.soup = soup, .map = vertex_map};
  size_t bucket_count = vxm_radix_partition_advise(soup->corner_count);
  while (soup->vertex_count > bucket_count << A_BITS)
    bucket_count *= 2;
  while (soup->vertex_count > bucket_count << b.low_bits)
    b.low_bits++;
  vxm_status status =
      vxm_radix_partition_fill(&b.buckets, context, soup->face_count, bucket_count, emit_sides, &b, &local);
  if (status == VXM_OK) {
    status = build(&b, &out->count, sided, context, &local);
    vxm_radix_partition_free(&b.buckets);
  }
  vxm_free(context, b.before);
  vxm_free(context, b.first_edge);
  if (status == VXM_OK) {
    *out = (vxm_edges){context, b.edges, out->count, b.sides, b.odd, b.open, b.crowded, b.against};
    return status;
  }
  vxm_free(context, b.sides);
  vxm_free(context, b.edges);
  *out = (vxm_edges){0};
  vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_edges_build(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                           const uint32_t *vertex_map, vxm_error *error) {
  return run(out, false, context, soup, vertex_map, error);
}

vxm_status vxm_edges_build_sides(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                                 const uint32_t *vertex_map, vxm_error *error) {
  return run(out, true, context, soup, vertex_map, error);
}

void vxm_edges_destroy(vxm_edges *edges) {
  if (!edges->context)
    return;
  vxm_free(edges->context, edges->sides);
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
