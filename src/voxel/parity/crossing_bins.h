/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Flips on their way from triangles to slabs.
 *
 * Threads that raster triangles each have a bin for every slab (and every voter), and append to it the places
 * of the bits to flip; later the thread that owns a slab takes them out of all threads' bins. A bin holds the
 * flips of part after part, in increasing order, each part's led in by a mark. Where one part flips more
 * often than a slab has words, its bin becomes a bitmap of the slab, so that the memory is bounded.
 */
#ifndef VXM_VOXEL_PARITY_CROSSING_BINS_H
#define VXM_VOXEL_PARITY_CROSSING_BINS_H

#include "base/context.h"

#include <stdatomic.h>

/** Set in a record that names the part of those behind it; else a record is a bit's place in its slab. */
#define VXM_BIN_MARK (UINT64_C(1) << 63)
/** No part. */
#define VXM_BIN_NONE UINT32_MAX

/** Words behind the limit of a bin that may be written, so that a vector of records can be stored at once. */
enum { VXM_BIN_SLACK = 8 };

typedef struct vxm_chunk {
  struct vxm_chunk *next;
  uint32_t capacity; /**< records, or words of a bitmap */
  bool is_bitmap;
  uint64_t *end; /**< behind the last record */
  uint64_t data[];
} vxm_chunk;

/** The bin of one thread, voter and slab. */
typedef struct vxm_crossing_bin {
  uint64_t *at, *limit; /**< the next record, and where `last` counts as full; `at` may be up to
                           VXM_BIN_SLACK beyond */
  vxm_chunk *first, *last;
  uint64_t *bitmap; /**< of the present part, once there is one */
  size_t part_records;
  uint32_t part;
} vxm_crossing_bin;

typedef struct vxm_arena {
  struct vxm_block *first, *present; /**< blocks kept from one use to the next */
  size_t used;                       /**< words of `present` */
} vxm_arena;

typedef struct vxm_crossing_bins {
  vxm_context *context;
  size_t workers, voters, slabs, slab_words;
  vxm_crossing_bin *bins;
  size_t bin_capacity;
  vxm_arena *arenas; /**< of each worker */
  size_t arena_capacity;
  uint64_t *trash;   /**< a word per worker, where records go after memory ran out */
  atomic_int failed; /**< a vxm_status */
} vxm_crossing_bins;

/** Makes empty bins, with the memory of those before. Start from {.context = ...}. */
vxm_status vxm_crossing_bins_reset(vxm_crossing_bins *bins, size_t workers, size_t voters, size_t slabs,
                                   size_t slab_words, vxm_error *error);
void vxm_crossing_bins_destroy(vxm_crossing_bins *bins);
/** Says why memory ran out while records were added, or VXM_OK. */
vxm_status vxm_crossing_bins_check(const vxm_crossing_bins *bins, vxm_error *error);

static inline vxm_crossing_bin *vxm_crossing_bins_at(const vxm_crossing_bins *bins, size_t worker,
                                                     size_t voter, size_t slab) {
  return &bins->bins[(worker * bins->voters + voter) * bins->slabs + slab];
}

/** Makes room for at least one more record. */
void vxm_crossing_bin_grow(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin);

static inline void vxm_crossing_bin_put(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin,
                                        uint64_t record) {
  if (bin->at >= bin->limit)
    vxm_crossing_bin_grow(bins, worker, bin);
  *bin->at++ = record;
}

/** Begins the records of a part; parts come in increasing order. */
static inline void vxm_crossing_bin_begin(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin,
                                          uint32_t part) {
  if (bin->part == part)
    return;
  bin->part = part;
  bin->part_records = 0;
  bin->bitmap = NULL;
  vxm_crossing_bin_put(bins, worker, bin, VXM_BIN_MARK | part);
}

/* ---- Taking records out ---- */

typedef struct vxm_crossing_bin_reader {
  const vxm_chunk *chunk;
  const uint64_t *at;
  uint32_t part; /**< whose records come next; VXM_BIN_NONE at the end */
  bool one_part; /**< there is no other part, so no need to look for marks */
} vxm_crossing_bin_reader;

/** A run of records, or a bitmap of `count` words. */
typedef struct vxm_crossing_bin_piece {
  const uint64_t *data;
  size_t count;
  bool is_bitmap;
} vxm_crossing_bin_piece;

/** Starts at the first part of a bin; `one_part`: there is no other. */
vxm_crossing_bin_reader vxm_crossing_bin_read(vxm_crossing_bin *bin, bool one_part);
/** The next piece of the reader's part; false, and moved on to the next part, when there is no more. */
bool vxm_crossing_bin_next(vxm_crossing_bin_reader *reader, vxm_crossing_bin_piece *piece);

#endif
