/* SPDX-License-Identifier: BSD-3-Clause */
#include "carve/stock.h"
#include "base/hash.h"
#include "grid/octree_crop.h"
#include "grid/octree_pieces.h"

enum { TABLE_MIN = 64, BRICK = 4 };

vxm_stock vxm_stock_of_grid(vxm_grid *grid) {
  return (vxm_stock){.context = grid->context, .grid = grid};
}

vxm_stock vxm_stock_of_sparse(vxm_context *context, const vxm_sparse *sparse) {
  return (vxm_stock){.context = context, .sparse = sparse};
}

void vxm_stock_destroy(vxm_stock *stock) {
  for (size_t t = 0; t < stock->tile_capacity; t++)
    vxm_grid_destroy(stock->tiles[t].bits);
  vxm_free(stock->context, stock->tiles);
  *stock = (vxm_stock){0};
}

void vxm_stock_begin(vxm_stock *stock, vxm_error *error) {
  stock->removed = 0;
  stock->status = VXM_OK;
  stock->error = error;
  for (int a = 0; a < 3; a++) {
    stock->low[a] = INT64_MAX;
    stock->high[a] = INT64_MIN;
  }
}

/* ---- Tiles ---- */

/** Where a tile is in the table, or would be. */
static size_t place_of(const vxm_stock *stock, const int64_t at[3]) {
  uint64_t hash = 0;
  for (int a = 0; a < 3; a++)
    hash = vxm_hash_word(hash, (uint64_t)at[a]);
  size_t mask = stock->tile_capacity - 1, place = (size_t)hash & mask;
  for (; stock->tiles[place].bits; place = (place + 1) & mask) {
    const int64_t *other = stock->tiles[place].at;
    if (other[0] == at[0] && other[1] == at[1] && other[2] == at[2])
      break;
  }
  return place;
}

/** Makes room for one more tile in a table that is at most half full. */
static vxm_status grow_table(vxm_stock *stock, vxm_error *error) {
  if (stock->tile_capacity > 2 * stock->tile_count)
    return VXM_OK;
  vxm_stock larger = *stock;
  vxm_status status = VXM_OK;
  larger.tile_capacity = stock->tile_capacity ? 2 * stock->tile_capacity : TABLE_MIN;
  larger.tiles = vxm_try_calloc(stock->context, larger.tile_capacity, sizeof *larger.tiles, &status, error);
  if (!larger.tiles)
    return status;
  for (size_t t = 0; t < stock->tile_capacity; t++)
    if (stock->tiles[t].bits)
      larger.tiles[place_of(&larger, stock->tiles[t].at)] = stock->tiles[t];
  vxm_free(stock->context, stock->tiles);
  stock->tiles = larger.tiles;
  stock->tile_capacity = larger.tile_capacity;
  return VXM_OK;
}

static vxm_status make_tile(vxm_stock *stock, const int64_t at[3], vxm_error *error) {
  vxm_status status = grow_table(stock, error);
  if (status != VXM_OK)
    return status;
  vxm_stock_tile *tile = &stock->tiles[place_of(stock, at)];
  if (!tile->bits) {
    vxm_stock_tile made = {.at = {at[0], at[1], at[2]}};
    int64_t begin[3], end[3];
    for (int a = 0; a < 3; a++) {
      begin[a] = VXM_STOCK_TILE * at[a];
      end[a] = vxm_min(begin[a] + VXM_STOCK_TILE, stock->sparse->space.dims[a]);
    }
    status = vxm_octree_crop(&made.bits, stock->sparse, begin, end, error);
    if (status != VXM_OK)
      return status;
    *tile = made;
    stock->tile_count++;
  }
  stock->last = *tile;
  return VXM_OK;
}

/** The word of a tile that holds row (j,k); NULL after a failure. */
static uint64_t *tile_word(vxm_stock *stock, int64_t word, int64_t j, int64_t k) {
  const int64_t at[3] = {word, j / VXM_STOCK_TILE, k / VXM_STOCK_TILE};
  const vxm_stock_tile *last = &stock->last;
  if (!last->bits || last->at[0] != at[0] || last->at[1] != at[1] || last->at[2] != at[2]) {
    if (stock->status == VXM_OK)
      stock->status = make_tile(stock, at, stock->error);
    if (stock->status != VXM_OK)
      return NULL;
  }
  return vxm_grid_row(last->bits, j % VXM_STOCK_TILE, k % VXM_STOCK_TILE);
}

static uint64_t *word_of(vxm_stock *stock, int64_t word, int64_t j, int64_t k) {
  return stock->grid ? vxm_grid_row(stock->grid, j, k) + word : tile_word(stock, word, j, k);
}

/* ---- Cutting ---- */

bool vxm_stock_is_clear(vxm_stock *stock, const int64_t first[3], const int64_t last[3]) {
  for (int64_t word = first[0] / 64; word <= last[0] / 64; word++) {
    int64_t begin = vxm_max(first[0] - 64 * word, 0), end = vxm_min(last[0] - 64 * word, 63);
    uint64_t mask = vxm_low_bits((unsigned)end + 1) & ~vxm_low_bits((unsigned)begin);
    for (int64_t k = first[2]; k <= last[2]; k++)
      for (int64_t j = first[1]; j <= last[1]; j++) {
        const uint64_t *at = word_of(stock, word, j, k);
        if (at && *at & mask)
          return false;
      }
  }
  return true;
}

static void note(vxm_stock *stock, int64_t word, int64_t j, int64_t k, uint64_t gone) {
  const int64_t first = 64 * word + __builtin_ctzll(gone), last = 64 * word + 63 - __builtin_clzll(gone);
  stock->removed += vxm_popcount(gone);
  stock->low[0] = vxm_min(stock->low[0], first);
  stock->high[0] = vxm_max(stock->high[0], last);
  stock->low[1] = vxm_min(stock->low[1], j);
  stock->high[1] = vxm_max(stock->high[1], j);
  stock->low[2] = vxm_min(stock->low[2], k);
  stock->high[2] = vxm_max(stock->high[2], k);
}

void vxm_stock_clear(vxm_stock *stock, int64_t word, int64_t j, int64_t k, uint64_t mask) {
  uint64_t *at = word_of(stock, word, j, k);
  uint64_t gone = at ? *at & mask : 0;
  if (!gone)
    return;
  *at &= ~mask;
  note(stock, word, j, k, gone);
}

void vxm_stock_clear_span(vxm_stock *stock, int64_t j, int64_t k, int64_t begin, int64_t end) {
  for (int64_t word = begin / 64; begin < end; word++) {
    int64_t stop = vxm_min(end, 64 * (word + 1));
    uint64_t mask = vxm_low_bits((unsigned)(stop - begin - 1)) << 1 | 1;
    vxm_stock_clear(stock, word, j, k, mask << (begin % 64));
    begin = stop;
  }
}

/* ---- The octree ---- */

/** The voxels of a brick that lie within a tile. */
static uint64_t brick_of(const vxm_grid *bits, const int64_t at[3]) {
  uint64_t brick = 0;
  for (int64_t k = 0; k < BRICK && at[2] + k < bits->space.dims[2]; k++)
    for (int64_t j = 0; j < BRICK && at[1] + j < bits->space.dims[1]; j++) {
      uint64_t row = vxm_grid_row(bits, at[1] + j, at[2] + k)[0] >> at[0] & 15;
      brick |= row << vxm_octree_bit(0, j, k);
    }
  return brick;
}

/** Tells what a tile has lost. */
static void compare_tile(vxm_octree_pieces *lost, const vxm_sparse *before, const vxm_stock_tile *tile) {
  const int64_t *dims = tile->bits->space.dims;
  for (int64_t k = 0; k < dims[2]; k += BRICK)
    for (int64_t j = 0; j < dims[1]; j += BRICK)
      for (int64_t i = 0; i < dims[0]; i += BRICK) {
        const int64_t within[3] = {i, j, k};
        int64_t at[3];
        for (int a = 0; a < 3; a++)
          at[a] = VXM_STOCK_TILE * tile->at[a] + within[a];
        uint64_t gone = vxm_octree_brick(before, at[0], at[1], at[2]) & ~brick_of(tile->bits, within);
        if (gone)
          vxm_octree_pieces_brick(lost, at, gone);
      }
}

vxm_status vxm_stock_octree(vxm_sparse **out, const vxm_stock *stock, vxm_error *error) {
  vxm_octree_pieces lost = {.context = stock->context, .space = stock->sparse->space, .error = error};
  for (size_t t = 0; t < stock->tile_capacity; t++)
    if (stock->tiles[t].bits)
      compare_tile(&lost, stock->sparse, &stock->tiles[t]);
  vxm_sparse *gone = NULL;
  vxm_status status = vxm_octree_pieces_end(&gone, &lost);
  if (status == VXM_OK)
    status = vxm_octree_combine(out, stock->sparse, gone, VXM_SET_DIFFERENCE, error);
  vxm_sparse_destroy(gone);
  return status;
}
