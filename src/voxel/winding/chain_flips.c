/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/chain_flips.h"
#include "mesh/sort.h"

#include <stdlib.h>
#include <string.h>

enum { INSERTED_MOST = 32 /**< crossings of a row that are sorted by insertion */ };

/* ---- Out of the bins ---- */

/** Goes through a slab's crossings: first where triangles are entered, then where they are left. */
typedef struct chain_reader {
  const vxm_chain_winding *chain;
  size_t slab, worker;
  int kind;
  vxm_crossing_bin_reader bin;
} chain_reader;

static vxm_crossing_bin_reader open_bin(const chain_reader *r) {
  return vxm_crossing_bin_read(vxm_crossing_bins_at(&r->chain->bins[r->kind], r->worker, 0, r->slab), true);
}

static chain_reader read_slab(const vxm_chain_winding *chain, size_t slab) {
  chain_reader reader = {.chain = chain, .slab = slab};
  reader.bin = open_bin(&reader);
  return reader;
}

static bool next_piece(chain_reader *r, vxm_crossing_bin_piece *piece) {
  for (;;) {
    while (r->bin.part != VXM_BIN_NONE)
      if (vxm_crossing_bin_next(&r->bin, piece))
        return true;
    if (++r->worker == r->chain->bins[r->kind].workers) {
      r->worker = 0;
      if (++r->kind == 2)
        return false;
    }
    r->bin = open_bin(r);
  }
}

/** Counts the crossings of each row, and of all. */
static size_t count_crossings(uint32_t *ends, const vxm_chain_winding *chain, size_t slab, int place_bits) {
  chain_reader reader = read_slab(chain, slab);
  vxm_crossing_bin_piece piece;
  size_t count = 0;
  while (next_piece(&reader, &piece)) {
    for (size_t i = 0; i < piece.count; i++)
      ends[piece.data[i] >> place_bits]++;
    count += piece.count;
  }
  return count;
}

/** Puts crossings into their rows: their places there, doubled, plus 1 where a triangle is left. */
static void put_crossings(vxm_chain_flips *out, const vxm_chain_winding *chain, size_t slab, int place_bits) {
  const uint64_t along = vxm_low_bits((unsigned)place_bits);
  chain_reader reader = read_slab(chain, slab);
  vxm_crossing_bin_piece piece;
  while (next_piece(&reader, &piece))
    for (size_t i = 0; i < piece.count; i++)
      out->places[out->ends[piece.data[i] >> place_bits]++] =
          (piece.data[i] & along) << 1 | (unsigned)reader.kind;
}

/* ---- Rows ---- */

static int compare(const void *a, const void *b) {
  const uint64_t *p = a, *q = b;
  return (*p > *q) - (*p < *q);
}

static void sort_row(uint64_t *crossings, size_t count) {
  if (count > INSERTED_MOST)
    qsort(crossings, count, sizeof *crossings, compare);
  else
    vxm_sort_few_keys(crossings, count);
}

/** Writes where a row, whose first place is `base`, comes to be wound around at least once, or ceases to be,
 * over crossings of its own or of rows before; returns the end of what is written. What changes to and fro in
 * one place is flipped twice there. */
static uint64_t *flip_row(uint64_t *out, const uint64_t *crossings, size_t count, uint64_t base) {
  int64_t wound = 0;
  for (size_t i = 0; i < count; i++) {
    uint64_t crossing = crossings[i];
    bool before = wound >= 1;
    wound += crossing & 1 ? -1 : 1;
    if (before != (wound >= 1))
      *out++ = base | crossing >> 1;
  }
  return out;
}

vxm_status vxm_chain_flips_take(vxm_chain_flips *out, const vxm_chain_winding *chain, size_t slab,
                                size_t rows, int place_bits) {
  vxm_context *context = chain->context;
  vxm_error local = VXM_ERROR_INIT;
  out->count = 0;
  if (vxm_renew(context, (void **)&out->ends, &out->row_capacity, rows, sizeof *out->ends, &local) != VXM_OK)
    return local.code;
  memset(out->ends, 0, rows * sizeof *out->ends);
  size_t count = count_crossings(out->ends, chain, slab, place_bits);
  if (count > UINT32_MAX)
    return VXM_ERROR_MEMORY;
  if (count > out->capacity && vxm_renew(context, (void **)&out->places, &out->capacity, count + count / 4,
                                         sizeof *out->places, &local) != VXM_OK)
    return local.code;
  uint32_t sum = 0;
  for (size_t r = 0; r < rows; r++) {
    uint32_t own = out->ends[r];
    out->ends[r] = sum;
    sum += own;
  }
  put_crossings(out, chain, slab, place_bits); /* moves the beginning of each row to its end */
  uint64_t *flips = out->places;
  for (size_t r = 0, begin = 0; r < rows; begin = out->ends[r++]) {
    size_t own = out->ends[r] - begin;
    sort_row(out->places + begin, own);
    flips = flip_row(flips, out->places + begin, own, (uint64_t)r << place_bits);
  }
  out->count = (size_t)(flips - out->places);
  return VXM_OK;
}

void vxm_chain_flips_destroy(vxm_chain_flips *flips, vxm_context *context) {
  vxm_free(context, flips->places);
  vxm_free(context, flips->ends);
}
