/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/side_table.h"

#include "base/threads.h"

enum {
  SLICES_MAX = 8,
  FACES_PER_SLICE = 1 << 14 /**< at least */
};

/* A counting sort. Each slice of the faces has counters of its own, which become the places it writes to, so
   that the order is that of faces whatever the number of slices. */

typedef struct building {
  vxm_context *context;
  const vxm_soup *soup;
  const uint32_t *map;
  size_t slices;
  uint32_t *next[SLICES_MAX]; /**< per slice, two per vertex: numbers of sides, then places */
  uint64_t *records;          /**< NULL while they are counted */
  bool others[SLICES_MAX];    /**< per slice: it has faces that are no triangles */
  bool cancelled[SLICES_MAX]; /**< per slice: it has heard that it is over */
} building;

static inline uint32_t vertex_at(const building *b, size_t corner) {
  uint32_t v = b->soup->indices[corner];
  return b->map ? b->map[v] : v;
}

/** Without a branch on the direction, which nobody can tell. */
static inline void put_side(uint32_t *next, uint64_t *records, uint32_t from, uint32_t to, size_t corner) {
  size_t down = from > to, low = to < from ? to : from;
  uint64_t high = to < from ? from : to;
  uint32_t at = next[2 * low + down]++;
  if (records)
    records[at] = high << 32 | corner;
}

static void put_polygon(const building *b, uint32_t *next, uint64_t *records, size_t first, size_t count) {
  if (!vxm_face_has_three(b->soup->indices + first, count, b->map))
    return;
  for (size_t i = 0; i < count; i++) {
    uint32_t from = vertex_at(b, first + i), to = vertex_at(b, first + (i + 1 < count ? i + 1 : 0));
    if (from != to)
      put_side(next, records, from, to, first + i);
  }
}

static inline bool put_faces(const building *b, uint32_t *next, uint64_t *records, size_t begin, size_t end) {
  bool others = false;
  for (size_t f = begin; f < end; f++) {
    size_t first = (size_t)b->soup->offsets[f], count = (size_t)b->soup->offsets[f + 1] - first;
    if (count != 3) {
      others = true;
      put_polygon(b, next, records, first, count);
      continue;
    }
    uint32_t u = vertex_at(b, first), v = vertex_at(b, first + 1), w = vertex_at(b, first + 2);
    if (u == v || v == w || w == u)
      continue;
    put_side(next, records, u, v, first);
    put_side(next, records, v, w, first + 1);
    put_side(next, records, w, u, first + 2);
  }
  return others;
}

static void run_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  building *b = payload;
  size_t begin = vxm_slice_begin(b->soup->face_count, b->slices, slice);
  size_t end = vxm_slice_begin(b->soup->face_count, b->slices, slice + 1);
  uint32_t *next = b->next[slice];
  for (size_t from = begin, to; from < end; from = to) {
    to = end - from < FACES_PER_SLICE ? end : from + FACES_PER_SLICE;
    b->cancelled[slice] = vxm_check_cancelled(b->context, NULL) != VXM_OK;
    if (b->cancelled[slice])
      return;
    if (b->records)
      put_faces(b, next, b->records, from, to);
    else
      b->others[slice] |= put_faces(b, next, NULL, from, to);
  }
}

static vxm_status run_slices(building *b, vxm_error *error) {
  bool cancelled = false;
  vxm_parallel(b->context, b->slices, run_slice, b);
  for (size_t s = 0; s < b->slices; s++)
    cancelled |= b->cancelled[s];
  return cancelled ? vxm_fail_cancelled(error) : VXM_OK;
}

/** Turns numbers into places, and tells what they tell. */
static void place(vxm_side_table *out, building *b) {
  size_t total = 0;
  out->is_balanced = true;
  for (size_t v = 0; v < out->vertex_count; v++) {
    size_t sides[2];
    for (size_t down = 0; down < 2; down++) {
      size_t begin = total;
      for (size_t s = 0; s < b->slices; s++) {
        uint32_t *next = &b->next[s][2 * v + down], number = *next;
        *next = (uint32_t)total;
        total += number;
      }
      sides[down] = total - begin;
    }
    size_t most = sides[0] > sides[1] ? sides[0] : sides[1];
    out->largest = most > out->largest ? most : out->largest;
    out->is_balanced &= sides[0] == sides[1];
  }
  out->count = total;
}

/** As many as there are threads, unless counters would take more than records do. */
static size_t count_slices(const building *b) {
  size_t slices = b->soup->face_count / FACES_PER_SLICE + 1;
  size_t threads = (size_t)vxm_context_threads(b->context);
  slices = slices < threads ? slices : threads;
  slices = slices < SLICES_MAX ? slices : SLICES_MAX;
  while (slices > 1 && slices * b->soup->vertex_count > b->soup->corner_count)
    slices--;
  return slices;
}

static vxm_status build(vxm_side_table *out, building *b, vxm_error *error) {
  b->slices = count_slices(b);
  for (size_t s = 0; s < b->slices; s++) {
    b->next[s] = vxm_calloc(b->context, 2 * out->vertex_count, sizeof *b->next[s], error);
    if (!b->next[s])
      return error->code;
  }
  vxm_status status = run_slices(b, error);
  if (status != VXM_OK)
    return status;
  place(out, b);
  b->records = out->records = vxm_alloc(b->context, out->count, sizeof *out->records, error);
  return b->records ? run_slices(b, error) : error->code;
}

vxm_status vxm_side_table_build(vxm_side_table *out, vxm_context *context, const vxm_soup *soup,
                                const uint32_t *vertex_map, vxm_error *error) {
  *out = (vxm_side_table){.context = context, .vertex_count = soup->vertex_count, .is_triangles = true};
  if (soup->corner_count >= UINT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu corners are too many to number; split the mesh",
                    soup->corner_count);
  building b = {.context = context, .soup = soup, .map = vertex_map};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = build(out, &b, &local);
  if (status == VXM_OK) {
    out->ends = b.next[b.slices - 1]; /* which ends where the sides of the last faces do */
    b.next[b.slices - 1] = NULL;
  }
  for (size_t s = 0; s < b.slices; s++) {
    out->is_triangles &= !b.others[s];
    vxm_free(context, b.next[s]);
  }
  if (status != VXM_OK) {
    vxm_side_table_destroy(out);
    vxm_error_pass(error, &local);
  }
  return status;
}

void vxm_side_table_destroy(vxm_side_table *table) {
  if (!table->context)
    return;
  vxm_free(table->context, table->records);
  vxm_free(table->context, table->ends);
  *table = (vxm_side_table){0};
}
