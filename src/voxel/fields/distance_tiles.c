/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/distance_tiles.h"
#include "base/bits.h"
#include "voxel/fields/distance_search.h"

enum {
  TILE = VXM_BAND_TILE,
  WORDS = 8 /**< looked at together: a line of cache */
};

_Static_assert((int)TILE == (int)VXM_VALUE_TILE && 64 % (int)TILE == 0, "tiles are handed on as they are");

static void put(vxm_distance_tiles *tiles, const vxm_value_tile *tile) {
  const vxm_field_target *target = tiles->target;
  if (tiles->error.code == VXM_OK)
    target->put_tile(target->payload, tile, &tiles->error);
}

static void put_values(vxm_distance_tiles *tiles, const int64_t first[3], const int count[3]) {
  vxm_value_tile tile = {
      .values = tiles->values, .row = TILE, .slice = (size_t)TILE * TILE, .value = tiles->values[0]};
  for (int a = 0; a < 3; a++) {
    tile.first[a] = first[a];
    tile.count[a] = count[a];
  }
  put(tiles, &tile);
}

/** Where the values of a tile of a row go, and its signs. */
static vxm_band_values values_of(vxm_distance_tiles *tiles, const vxm_band_values *out, int64_t off) {
  vxm_band_values own = *out;
  own.values = tiles->values;
  own.row = TILE;
  own.slice = (size_t)TILE * TILE;
  if (own.words)
    own.words += (own.shift + off) / 64;
  own.shift = (int)((own.shift + off) % 64);
  return own;
}

void vxm_distance_tiles_finish(vxm_distance_tiles *tiles, const vxm_band_kernels *kernels,
                               const vxm_band_values *out, const vxm_band_tile *tile, vxm_band_tally *tally) {
  vxm_band_values own = values_of(tiles, out, 0);
  kernels->finish(&own, tile, tally);
  put_values(tiles, tile->first, tile->count);
}

/* ---- Beyond the band ---- */

/** A tile in whose rows the bits `any` are inside somewhere, the bits `all` everywhere. */
static void put_far(vxm_distance_tiles *tiles, const vxm_band_kernels *kernels, const vxm_band_values *out,
                    const int64_t at[3], const int64_t count[3], int64_t off, uint64_t any, uint64_t all,
                    vxm_band_tally *tally) {
  const float most = (float)(out->band * out->side);
  vxm_value_tile tile = {.first = {at[0] + off, at[1], at[2]},
                         .count = {(int)vxm_min(count[0] - off, TILE), (int)count[1], (int)count[2]},
                         .value = -most};
  const uint64_t valid = vxm_low_bits((unsigned)tile.count[0]);
  if ((any & valid) == 0)
    vxm_band_tally_add(tally, most);
  else if ((all & valid) == valid) {
    vxm_band_tally_add(tally, -most);
    tally->inside += count[1] * count[2] * tile.count[0];
    put(tiles, &tile);
  } else {
    vxm_band_values own = values_of(tiles, out, off);
    kernels->fill(&own, (const int64_t[3]){tile.count[0], count[1], count[2]}, tally);
    put_values(tiles, tile.first, tile.count);
  }
}

/** What the words of all rows have in common. */
static void scan(uint64_t any[WORDS], uint64_t all[WORDS], const vxm_band_values *out, size_t word,
                 size_t words, const int64_t count[3]) {
  for (size_t w = 0; w < WORDS; w++) {
    any[w] = 0;
    all[w] = ~UINT64_C(0);
  }
  for (int64_t z = 0; z < count[2]; z++)
    for (int64_t y = 0; y < count[1]; y++) {
      const uint64_t *row = out->words + (size_t)z * out->slice_words + (size_t)y * out->row_words + word;
      for (size_t w = 0; w < words; w++) {
        any[w] |= row[w];
        all[w] &= row[w];
      }
    }
}

void vxm_distance_tiles_fill(vxm_distance_tiles *tiles, const vxm_band_kernels *kernels,
                             const vxm_band_values *out, const int64_t at[3], const int64_t count[3],
                             vxm_band_tally *tally) {
  if (!out->words) {
    vxm_band_tally_add(tally, (float)(out->band * out->side));
    return;
  }
  size_t ends = (size_t)(out->shift + count[0] + 63) / 64;
  uint64_t any[WORDS], all[WORDS];
  for (int64_t off = 0; off < count[0]; off += TILE) {
    size_t bit = (size_t)(out->shift + off), word = bit / 64;
    if (off == 0 || bit % (WORDS * 64) == 0)
      scan(any, all, out, word / WORDS * WORDS,
           (size_t)vxm_min((int64_t)(ends - word / WORDS * WORDS), WORDS), count);
    put_far(tiles, kernels, out, at, count, off, any[word % WORDS] >> (bit % 64),
            all[word % WORDS] >> (bit % 64), tally);
  }
}
