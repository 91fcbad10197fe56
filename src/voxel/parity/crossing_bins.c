/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/crossing_bins.h"

#include <string.h>

enum {
  CHUNK_FIRST = 20, /**< records; with head and slack, whole cache lines */
  CHUNK_MOST = 1012,
  HEAD_WORDS = sizeof(vxm_chunk) / sizeof(uint64_t),
  BLOCK_FIRST = 4 << 10, /**< words */
  BLOCK_MOST = 128 << 10
};

typedef struct vxm_block {
  struct vxm_block *next;
  size_t words;
  uint64_t data[];
} vxm_block;

/* ---- Memory ---- */

/** Words from a worker's blocks; NULL if there are none left. */
static uint64_t *take(vxm_crossing_bins *bins, size_t worker, size_t words) {
  vxm_arena *arena = &bins->arenas[worker];
  while (arena->present && arena->used + words > arena->present->words && arena->present->next) {
    arena->present = arena->present->next;
    arena->used = 0;
  }
  if (!arena->present || arena->used + words > arena->present->words) {
    size_t size = arena->present ? 2 * arena->present->words : BLOCK_FIRST;
    size = size > BLOCK_MOST ? BLOCK_MOST : size;
    size = size < words ? words : size;
    vxm_error local = VXM_ERROR_INIT;
    vxm_block *block =
        vxm_alloc(bins->context, sizeof *block / sizeof(uint64_t) + size, sizeof(uint64_t), &local);
    if (!block) {
      atomic_store_explicit(&bins->failed, (int)local.code, memory_order_relaxed);
      return NULL;
    }
    block->next = NULL;
    block->words = size;
    if (arena->present)
      arena->present->next = block;
    else
      arena->first = block;
    arena->present = block;
    arena->used = 0;
  }
  uint64_t *data = arena->present->data + arena->used;
  arena->used += words;
  return data;
}

static void free_blocks(vxm_crossing_bins *bins) {
  for (size_t w = 0; w < bins->arena_capacity; w++)
    for (vxm_block *block = bins->arenas[w].first; block;) {
      vxm_block *next = block->next;
      vxm_free(bins->context, block);
      block = next;
    }
}

void vxm_crossing_bins_destroy(vxm_crossing_bins *bins) {
  free_blocks(bins);
  vxm_free(bins->context, bins->arenas);
  vxm_free(bins->context, bins->bins);
  vxm_free(bins->context, bins->trash);
  *bins = (vxm_crossing_bins){.context = bins->context};
}

static vxm_status reserve(vxm_crossing_bins *bins, size_t count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  if (count > bins->bin_capacity) {
    vxm_free(bins->context, bins->bins);
    bins->bin_capacity = 0;
    bins->bins = vxm_alloc(bins->context, count, sizeof *bins->bins, &local);
    bins->bin_capacity = bins->bins ? count : 0;
  }
  if (bins->workers > bins->arena_capacity) {
    free_blocks(bins);
    vxm_free(bins->context, bins->arenas);
    bins->arena_capacity = 0;
    vxm_free(bins->context, bins->trash);
    bins->trash = vxm_alloc(bins->context, bins->workers * (VXM_BIN_SLACK + 1), sizeof *bins->trash, &local);
    bins->arenas = vxm_calloc(bins->context, bins->workers, sizeof *bins->arenas, &local);
    bins->arena_capacity = bins->arenas && bins->trash ? bins->workers : 0;
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_crossing_bins_reset(vxm_crossing_bins *bins, size_t workers, size_t voters, size_t slabs,
                                   size_t slab_words, vxm_error *error) {
  bins->workers = workers;
  bins->voters = voters;
  bins->slabs = slabs;
  bins->slab_words = slab_words;
  atomic_init(&bins->failed, VXM_OK);
  size_t count = workers * voters * slabs;
  vxm_status status = reserve(bins, count, error);
  if (status != VXM_OK)
    return status;
  memset(bins->bins, 0, count * sizeof *bins->bins);
  for (size_t b = 0; b < count; b++)
    bins->bins[b].part = VXM_BIN_NONE;
  for (size_t w = 0; w < workers; w++) {
    bins->arenas[w].present = bins->arenas[w].first;
    bins->arenas[w].used = 0;
  }
  return VXM_OK;
}

vxm_status vxm_crossing_bins_check(const vxm_crossing_bins *bins, vxm_error *error) {
  vxm_status status = (vxm_status)atomic_load_explicit(&bins->failed, memory_order_relaxed);
  if (status == VXM_OK)
    return VXM_OK;
  return vxm_fail(
      error, status,
      "the memory for the crossings of triangles ran out; raise the limit (--memlimit) or lower the "
      "resolution (-r)");
}

/* ---- Adding ---- */

static bool add_chunk(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin, size_t capacity,
                      bool is_bitmap) {
  vxm_chunk *chunk = (vxm_chunk *)(void *)take(bins, worker, HEAD_WORDS + capacity + VXM_BIN_SLACK);
  if (!chunk) { /* all of it fails; until then records go where nobody reads */
    bin->at = bins->trash + worker * (VXM_BIN_SLACK + 1);
    bin->limit = bin->at + 1;
    return false;
  }
  chunk->next = NULL;
  chunk->capacity = (uint32_t)capacity;
  chunk->is_bitmap = is_bitmap;
  chunk->end = chunk->data;
  if (bin->last)
    bin->last->next = chunk;
  else
    bin->first = chunk;
  bin->last = chunk;
  bin->at = chunk->data;
  bin->limit = chunk->data + capacity;
  return true;
}

/** Goes over to a bitmap for the present part. */
static void add_bitmap(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin) {
  if (!add_chunk(bins, worker, bin, bins->slab_words, true))
    return;
  bin->bitmap = bin->last->data;
  memset(bin->bitmap, 0, bins->slab_words * sizeof *bin->bitmap);
  bin->last->end = bin->limit;
  add_chunk(bins, worker, bin, CHUNK_MOST, false);
}

void vxm_crossing_bin_grow(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin) {
  if (atomic_load_explicit(&bins->failed, memory_order_relaxed) != VXM_OK) {
    bin->at = bins->trash + worker * (VXM_BIN_SLACK + 1);
    bin->limit = bin->at + 1;
    return;
  }
  if (bin->bitmap) { /* `last` holds records behind the bitmap: put them into it */
    for (const uint64_t *r = bin->last->data; r < bin->at; r++)
      bin->bitmap[*r / 64] ^= UINT64_C(1) << (*r % 64);
    bin->at = bin->last->data;
    return;
  }
  size_t capacity = CHUNK_FIRST;
  if (bin->last) {
    bin->last->end = bin->at;
    capacity = bin->last->is_bitmap ? CHUNK_FIRST : 2 * (size_t)bin->last->capacity + 12;
    bin->part_records += bin->last->capacity;
  }
  if (bin->part_records > bins->slab_words + CHUNK_MOST)
    add_bitmap(bins, worker, bin);
  else
    add_chunk(bins, worker, bin, capacity > CHUNK_MOST ? CHUNK_MOST : capacity, false);
}

/* ---- Taking out ---- */

/** Skips finished chunks; then the reader is at a record or a bitmap, or chunk is NULL. */
static void skip_finished(vxm_crossing_bin_reader *reader) {
  while (reader->chunk && reader->at == reader->chunk->end) {
    reader->chunk = reader->chunk->next;
    reader->at = reader->chunk ? reader->chunk->data : NULL;
  }
}

static void read_mark(vxm_crossing_bin_reader *reader) {
  skip_finished(reader);
  reader->part = reader->chunk ? (uint32_t)(*reader->at++ & UINT32_MAX) : VXM_BIN_NONE;
}

vxm_crossing_bin_reader vxm_crossing_bin_read(vxm_crossing_bin *bin, bool one_part) {
  if (bin->last)
    bin->last->end = bin->at;
  vxm_crossing_bin_reader reader = {bin->first, bin->first ? bin->first->data : NULL, VXM_BIN_NONE, one_part};
  read_mark(&reader);
  return reader;
}

bool vxm_crossing_bin_next(vxm_crossing_bin_reader *reader, vxm_crossing_bin_piece *piece) {
  skip_finished(reader);
  const vxm_chunk *chunk = reader->chunk;
  if (chunk && chunk->is_bitmap) {
    *piece = (vxm_crossing_bin_piece){chunk->data, chunk->capacity, true};
    reader->at = chunk->end;
    return true;
  }
  if (!chunk || *reader->at & VXM_BIN_MARK) {
    read_mark(reader);
    return false;
  }
  const uint64_t *end = reader->one_part ? chunk->end : reader->at;
  while (end < chunk->end && !(*end & VXM_BIN_MARK))
    end++;
  *piece = (vxm_crossing_bin_piece){reader->at, (size_t)(end - reader->at), false};
  reader->at = end;
  return true;
}
