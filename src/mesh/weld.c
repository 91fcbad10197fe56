/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/weld.h"

#include "base/threads.h"
#include "mesh/position_hash.h"
#include "mesh/radix_partition.h"

#include <math.h>
#include <string.h>

/** Equal as numbers is equal in bits once -0.0 is 0.0; NaN never gets here. */
static bool same_position(const double *p, const double *q) {
  return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

typedef struct welding {
  const double *positions;
  uint32_t *map;
  unsigned bucket_shift;
  vxm_radix_partition buckets;
  uint32_t *tables; /**< one hash table per worker: place of a record in its bucket + 1, or 0 */
  size_t table_size;
} welding;

/** Records are (low half of the hash, vertex); the bucket is told by the top of the hash. */
static void emit_vertices(size_t begin, size_t end, vxm_sink *sink, void *payload) {
  welding *w = payload;
  for (size_t v = begin; v < end; v++) {
    const double *p = w->positions + 3 * v;
    if (isnan(p[0]) || isnan(p[1]) || isnan(p[2])) {
      w->map[v] = (uint32_t)v;
      continue;
    }
    uint64_t hash = vxm_position_hash(p[0], p[1], p[2]);
    vxm_sink_put(sink, (size_t)(hash >> w->bucket_shift), hash << 32 | v);
  }
}

static void weld_bucket(size_t bucket, int worker, void *payload) {
  enum { AHEAD = 12 };
  welding *w = payload;
  const uint64_t *records = w->buckets.records + w->buckets.begin[bucket];
  size_t count = w->buckets.begin[bucket + 1] - w->buckets.begin[bucket];
  uint32_t *table = w->tables + (size_t)worker * w->table_size;
  size_t mask = vxm_hash_slots(count) - 1;
  memset(table, 0, (mask + 1) * sizeof *table);
  for (size_t i = 0; i < count; i++) {
    if (i + AHEAD < count)
      __builtin_prefetch(w->positions + 3 * (size_t)(uint32_t)records[i + AHEAD]);
    uint32_t vertex = (uint32_t)records[i], hash = (uint32_t)(records[i] >> 32);
    size_t slot = hash & mask;
    for (; table[slot] != 0; slot = (slot + 1) & mask) {
      uint64_t other = records[table[slot] - 1];
      if ((uint32_t)(other >> 32) == hash &&
          same_position(w->positions + 3 * (size_t)vertex, w->positions + 3 * (size_t)(uint32_t)other))
        break;
    }
    if (table[slot] == 0)
      table[slot] = (uint32_t)i + 1;
    w->map[vertex] = (uint32_t)records[table[slot] - 1];
  }
}

vxm_status vxm_weld_exact(vxm_context *context, const double *positions, size_t count, uint32_t *map,
                          size_t *distinct, vxm_error *error) {
  size_t bucket_count = vxm_radix_partition_advise(count);
  welding w = {.positions = positions, .map = map};
  w.bucket_shift = 64 - (unsigned)__builtin_ctzll(bucket_count);
  vxm_status status =
      vxm_radix_partition_fill(&w.buckets, context, count, bucket_count, emit_vertices, &w, error);
  if (status != VXM_OK)
    return status;
  w.table_size = vxm_hash_slots(w.buckets.largest);
  vxm_error local = VXM_ERROR_INIT;
  w.tables =
      vxm_alloc(context, (size_t)vxm_context_threads(context) * w.table_size, sizeof *w.tables, &local);
  status = w.tables ? vxm_parallel_cancellable(context, bucket_count, weld_bucket, &w, &local) : local.code;
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  vxm_free(context, w.tables);
  vxm_radix_partition_destroy(&w.buckets);
  if (status == VXM_OK && distinct) {
    *distinct = 0;
    for (size_t v = 0; v < count; v++)
      *distinct += map[v] == v;
  }
  return status;
}
