/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Distribution of 64-bit records into buckets: the first step of welding and of the search for repeated
 * faces. A bucket then fits a cache and is worked on by one task alone.
 */
#ifndef VXM_MESH_RADIX_PARTITION_H
#define VXM_MESH_RADIX_PARTITION_H

#include "base/context.h"

/** Records of bucket i are records[begin[i]] to records[begin[i+1]-1], in the order they were put. */
typedef struct vxm_radix_partition {
  vxm_context *context;
  uint64_t *records;
  size_t *begin; /**< count + 1 */
  size_t count;
  size_t largest; /**< records of the fullest bucket */
} vxm_radix_partition;

/** Where an emitter puts its records; it counts them in a first run and stores them in a second. */
typedef struct vxm_sink {
  size_t *next;
  uint64_t *records; /**< NULL in the first run */
} vxm_sink;

static inline void vxm_sink_put(vxm_sink *sink, size_t bucket, uint64_t record) {
  size_t at = sink->next[bucket]++;
  if (sink->records)
    sink->records[at] = record;
}

/** Puts the records of items begin..end-1, the same ones in both runs. */
typedef void (*vxm_emit_fn)(size_t begin, size_t end, vxm_sink *sink, void *payload);

/** A power of two that leaves some thousand records in a bucket, at least 2. */
size_t vxm_radix_partition_advise(size_t records);

/**
 * Runs `emit` twice over slices of 0..items-1, in parallel. The order within a bucket is that of the items,
 * whatever the number of threads. A failure leaves nothing to free.
 */
vxm_status vxm_radix_partition_fill(vxm_radix_partition *out, vxm_context *context, size_t items,
                                    size_t bucket_count, vxm_emit_fn emit, void *payload, vxm_error *error);
void vxm_radix_partition_destroy(vxm_radix_partition *buckets);

#endif
