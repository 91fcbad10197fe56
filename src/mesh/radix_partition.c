/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/radix_partition.h"

#include "base/threads.h"

#include <string.h>

enum {
  BUCKETS_MAX = 2048,
  RECORDS_WANTED = 2048,
  ITEMS_PER_SLICE = 4096,
  SLICES_LEAST = 64 /**< of what is large: between two of them it can be cancelled */
};

size_t vxm_radix_partition_advise(size_t records) {
  size_t count = 2;
  while (count < BUCKETS_MAX && count * RECORDS_WANTED < records)
    count *= 2;
  return count;
}

typedef struct distribution {
  vxm_radix_partition *buckets;
  size_t *next; /**< slices x buckets: first the counts, then the places to write to */
  size_t items, slices;
  vxm_emit_fn emit;
  void *payload;
  uint64_t *records;
} distribution;

static void run_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  distribution *d = payload;
  vxm_sink sink = {d->next + slice * d->buckets->count, d->records};
  d->emit(vxm_slice_begin(d->items, d->slices, slice), vxm_slice_begin(d->items, d->slices, slice + 1), &sink,
          d->payload);
}

/** Turns the counts into places, bucket after bucket and within a bucket slice after slice. */
static size_t place_records(distribution *d) {
  vxm_radix_partition *buckets = d->buckets;
  size_t total = 0;
  for (size_t b = 0; b < buckets->count; b++) {
    buckets->begin[b] = total;
    for (size_t s = 0; s < d->slices; s++) {
      size_t *next = d->next + s * buckets->count + b;
      size_t count = *next;
      *next = total;
      total += count;
    }
    if (total - buckets->begin[b] > buckets->largest)
      buckets->largest = total - buckets->begin[b];
  }
  buckets->begin[buckets->count] = total;
  return total;
}

vxm_status vxm_radix_partition_fill(vxm_radix_partition *out, vxm_context *context, size_t items,
                                    size_t bucket_count, vxm_emit_fn emit, void *payload, vxm_error *error) {
  *out = (vxm_radix_partition){.context = context, .count = bucket_count};
  size_t slices = items / ITEMS_PER_SLICE + 1, most = 4 * (size_t)vxm_context_threads(context);
  distribution d = {.buckets = out, .items = items, .emit = emit, .payload = payload};
  most = most > SLICES_LEAST ? most : SLICES_LEAST;
  d.slices = slices < most ? slices : most;
  vxm_error local = VXM_ERROR_INIT;
  d.next = vxm_calloc(context, d.slices * bucket_count, sizeof *d.next, &local);
  if (d.next)
    out->begin = vxm_alloc(context, bucket_count + 1, sizeof *out->begin, &local);
  if (out->begin && vxm_parallel_cancellable(context, d.slices, run_slice, &d, &local) == VXM_OK)
    out->records = vxm_alloc(context, place_records(&d), sizeof *out->records, &local);
  d.records = out->records;
  bool done = d.records && vxm_parallel_cancellable(context, d.slices, run_slice, &d, &local) == VXM_OK;
  vxm_free(context, d.next);
  if (done)
    return VXM_OK;
  vxm_radix_partition_destroy(out);
  vxm_error_pass(error, &local);
  return local.code;
}

void vxm_radix_partition_destroy(vxm_radix_partition *buckets) {
  if (!buckets->context)
    return;
  vxm_free(buckets->context, buckets->records);
  vxm_free(buckets->context, buckets->begin);
  *buckets = (vxm_radix_partition){0};
}
