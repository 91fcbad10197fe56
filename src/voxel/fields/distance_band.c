/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/distance_band.h"
#include "base/bits.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "voxel/fields/distance_tiles.h"

#include <math.h>

/* The tiles of a grid that lie side by side along rows are a bin. */

/** From so many values on what is beyond the band is written past the cache: it would not stay there. */
static const int64_t streaming_values = INT64_C(1) << 24;

enum { TASKS = 8 /**< for each worker, if there are tiles enough */ };

struct vxm_distance_band {
  const vxm_band_clusters *clusters;
  const vxm_band_kernels *kernels;
  int workers;
  vxm_band_tile *tiles;    /**< of each worker */
  uint32_t *near;          /**< clusters near a tile, of each worker */
  size_t *starts;          /**< of the bins at hand, and the end of the last */
  uint32_t *entries;       /**< the clusters of some bins */
  size_t capacity;         /**< of entries: the clusters of any one bin at least */
  int64_t across, down;    /**< bins beside each other: tiles in a row, rows of tiles in a slice */
  int64_t begin, end;      /**< slices at hand */
  size_t first_bin, base;  /**< whose entries are at hand, and where they would begin */
  int64_t piece, pieces;   /**< tiles of a bin that are one task, and tasks in a bin */
  vxm_band_values out;     /**< of the first slice */
  vxm_distance_tiles *put; /**< of each worker; NULL where values are written to `out` */
  vxm_band_tally *tallies;
  vxm_task_progress progress;
};

static int64_t tiles_of(int64_t voxels) {
  return (voxels + VXM_BAND_TILE - 1) / VXM_BAND_TILE;
}

static size_t capacity_of(size_t clusters) {
  return 4 * clusters + 4096;
}

/* ---- Bins ---- */

/** The bins that a cluster has to do with, among those of the slices at hand; false if there are none. */
static bool bins_of(const vxm_distance_band *band, const vxm_band_cluster *cluster, int64_t low[2],
                    int64_t high[2]) {
  int64_t begin = vxm_max(cluster->box[2][0], band->begin), end = vxm_min(cluster->box[2][1], band->end);
  if (cluster->box[0][0] >= cluster->box[0][1] || begin >= end)
    return false;
  low[0] = cluster->box[1][0] / VXM_BAND_TILE;
  high[0] = (cluster->box[1][1] - 1) / VXM_BAND_TILE;
  low[1] = (begin - band->begin) / VXM_BAND_TILE;
  high[1] = (end - 1 - band->begin) / VXM_BAND_TILE;
  return true;
}

static size_t bin_count(const vxm_distance_band *band) {
  return (size_t)(band->down * tiles_of(band->end - band->begin));
}

/** Where the clusters of each bin would begin, if there were room for all. */
static void count_entries(vxm_distance_band *band) {
  size_t bins = bin_count(band), sum = 0;
  int64_t low[2], high[2];
  for (size_t b = 0; b <= bins; b++)
    band->starts[b] = 0;
  for (size_t i = 0; i < band->clusters->count; i++)
    if (bins_of(band, &band->clusters->clusters[i], low, high))
      for (int64_t layer = low[1]; layer <= high[1]; layer++)
        for (int64_t row = low[0]; row <= high[0]; row++)
          band->starts[layer * band->down + row]++;
  for (size_t b = 0; b <= bins; b++) {
    size_t count = band->starts[b];
    band->starts[b] = sum;
    sum += count;
  }
}

/** Lists the clusters of bins `from` to `to` - 1; the starts of these bins become their ends. */
static void list_entries(vxm_distance_band *band, size_t from, size_t to) {
  size_t base = band->starts[from];
  int64_t low[2], high[2];
  for (size_t i = 0; i < band->clusters->count; i++) {
    if (!bins_of(band, &band->clusters->clusters[i], low, high))
      continue;
    for (int64_t layer = vxm_max(low[1], (int64_t)from / band->down);
         layer <= vxm_min(high[1], ((int64_t)to - 1) / band->down); layer++)
      for (int64_t row = low[0]; row <= high[0]; row++) {
        size_t bin = (size_t)(layer * band->down + row);
        if (bin >= from && bin < to)
          band->entries[band->starts[bin]++ - base] = (uint32_t)i;
      }
  }
}

/* ---- Tiles ---- */

/** Whether a cluster's box, in its own frame, reaches a tile: large triangles lie askew in theirs. */
static bool is_within_reach(const vxm_band_cluster *cluster, const vxm_band_grid *grid,
                            const vxm_band_tile *tile) {
  for (int a = 0; a < 3; a++) {
    double at = 0, reach = grid->band + cluster->margin;
    for (int c = 0; c < 3; c++) {
      double step = grid->step[grid->axes[c]], half = tile->count[c] / 2.0;
      at += cluster->axis[a][c] * (((double)tile->first[c] + half) * step - cluster->origin[grid->axes[c]]);
      reach += fabs((double)cluster->axis[a][c]) * half * step;
    }
    if (at + reach < (double)cluster->low[a] || at - reach > (double)cluster->high[a])
      return false;
  }
  return true;
}

size_t vxm_distance_band_near(const vxm_band_clusters *clusters, uint32_t *near, const uint32_t *entries,
                              size_t count, const vxm_band_tile *tile) {
  size_t found = 0;
  int64_t begin = tile->first[0], end = begin + tile->count[0];
  for (size_t i = 0; i < count; i++) {
    const vxm_band_cluster *cluster = &clusters->clusters[entries[i]];
    if (cluster->box[0][0] >= end || cluster->box[0][1] <= begin)
      continue;
    bool is_large = cluster->box[0][1] - cluster->box[0][0] > VXM_BAND_TILE ||
                    cluster->box[1][1] - cluster->box[1][0] > VXM_BAND_TILE ||
                    cluster->box[2][1] - cluster->box[2][0] > VXM_BAND_TILE;
    if (!is_large || is_within_reach(cluster, &clusters->grid, tile))
      near[found++] = entries[i];
  }
  return found;
}

/** Where the values go that begin at a voxel. */
static vxm_band_values values_at(const vxm_distance_band *band, const int64_t at[3]) {
  vxm_band_values out = band->out;
  size_t slice = (size_t)(at[2] - band->begin);
  if (out.values)
    out.values += slice * out.slice + (size_t)at[1] * out.row + (size_t)at[0];
  if (out.words)
    out.words += slice * out.slice_words + (size_t)at[1] * out.row_words + (size_t)at[0] / 64;
  out.shift = (int)(at[0] % 64);
  return out;
}

/** Fills the tiles from..to-1 of a bin, or puts those that are not all outside; `tile` is any of them. */
static void fill_tiles(const vxm_distance_band *band, int worker, const vxm_band_tile *tile, int64_t from,
                       int64_t to) {
  const int64_t at[3] = {from * VXM_BAND_TILE, tile->first[1], tile->first[2]};
  const int64_t count[3] = {vxm_min(to * VXM_BAND_TILE, band->clusters->grid.dims[0]) - at[0], tile->count[1],
                            tile->count[2]};
  if (from == to)
    return;
  vxm_band_values out = values_at(band, at);
  if (band->put)
    vxm_distance_tiles_fill(&band->put[worker], band->kernels, &out, at, count, &band->tallies[worker]);
  else
    band->kernels->fill(&out, count, &band->tallies[worker]);
}

/** Writes or puts a tile that has been measured. */
static void finish_tile(const vxm_distance_band *band, int worker, const vxm_band_tile *tile) {
  vxm_band_values out = values_at(band, tile->first);
  if (band->put)
    vxm_distance_tiles_finish(&band->put[worker], band->kernels, &out, tile, &band->tallies[worker]);
  else
    band->kernels->finish(&out, tile, &band->tallies[worker]);
}

static void measure_piece(size_t task, int worker, void *payload) {
  vxm_distance_band *band = payload;
  if (vxm_task_progress_stopped(&band->progress, worker))
    return;
  const int64_t *dims = band->clusters->grid.dims;
  size_t bin = band->first_bin + task / (size_t)band->pieces;
  int64_t from = (int64_t)(task % (size_t)band->pieces) * band->piece,
          to = vxm_min(from + band->piece, band->across), filled = from;
  size_t begin = bin > band->first_bin ? band->starts[bin - 1] : band->base;
  const uint32_t *entries = band->entries + (begin - band->base);
  size_t count = band->starts[bin] - begin;
  uint32_t *near = band->near + (size_t)worker * band->clusters->count;
  vxm_band_tile *tile = &band->tiles[worker];
  int64_t middle = (int64_t)bin % band->down * VXM_BAND_TILE,
          slow = band->begin + (int64_t)bin / band->down * VXM_BAND_TILE;
  tile->first[1] = middle;
  tile->count[1] = (int)vxm_min(dims[1] - middle, VXM_BAND_TILE);
  tile->first[2] = slow;
  tile->count[2] = (int)vxm_min(band->end - slow, VXM_BAND_TILE);
  for (int64_t t = from; t < to; t++) {
    tile->first[0] = t * VXM_BAND_TILE;
    tile->count[0] = (int)vxm_min(dims[0] - tile->first[0], VXM_BAND_TILE);
    size_t found = vxm_distance_band_near(band->clusters, near, entries, count, tile);
    if (found == 0)
      continue;
    fill_tiles(band, worker, tile, filled, t);
    filled = t + 1;
    band->kernels->measure(tile, band->clusters, near, found);
    finish_tile(band, worker, tile);
  }
  fill_tiles(band, worker, tile, filled, to);
  vxm_task_progress_step(&band->progress);
  if (band->put && band->put[worker].error.code != VXM_OK)
    atomic_store_explicit(&band->progress.stop, true, memory_order_relaxed);
}

/* ---- Slices ---- */

static vxm_status measure_bins(vxm_distance_band *band, vxm_error *error) {
  vxm_context *context = band->clusters->context;
  size_t bins = bin_count(band), pieces = (size_t)vxm_max(1, TASKS * band->workers / (int64_t)bins);
  band->piece = vxm_max(1, band->across / (int64_t)pieces);
  band->pieces = (band->across + band->piece - 1) / band->piece;
  count_entries(band);
  vxm_task_progress_start(&band->progress, context, "measuring distances", bins * (size_t)band->pieces,
                          error);
  for (size_t from = 0, to; from < bins && !atomic_load(&band->progress.stop); from = to) {
    band->first_bin = from;
    band->base = band->starts[from];
    for (to = from + 1; to < bins && band->starts[to + 1] - band->base <= band->capacity;)
      to++;
    list_entries(band, from, to);
    vxm_parallel(context, (to - from) * (size_t)band->pieces, measure_piece, band);
  }
  for (int w = 0; band->put && w < band->workers; w++)
    if (band->put[w].error.code != VXM_OK) {
      vxm_error_pass(error, &band->put[w].error);
      return band->put[w].error.code;
    }
  return vxm_task_progress_end(&band->progress);
}

static vxm_status make_tiles(vxm_distance_band *band, const vxm_field_target *target, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  band->put = vxm_alloc(band->clusters->context, (size_t)band->workers, sizeof *band->put, &local);
  for (int w = 0; w < band->workers && band->put; w++) {
    band->put[w].target = target;
    band->put[w].error = (vxm_error)VXM_ERROR_INIT;
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_distance_band_measure(vxm_distance_band *band, const vxm_field_target *target, float *values,
                                     const vxm_window *solid, int64_t begin, int64_t end, double side,
                                     vxm_band_tally *tallies, vxm_error *error) {
  const int64_t *dims = band->clusters->grid.dims;
  band->begin = begin;
  band->end = end;
  band->tallies = tallies;
  band->out =
      (vxm_band_values){.values = values,
                        .row = (size_t)dims[0],
                        .slice = (size_t)(dims[0] * dims[1]),
                        .words = solid->words,
                        .row_words = solid->row_words,
                        .slice_words = solid->slice_words,
                        .is_streaming = values && dims[0] * dims[1] * (end - begin) >= streaming_values,
                        .band = band->clusters->grid.band,
                        .side = side};
  vxm_status status = target ? make_tiles(band, target, error) : VXM_OK;
  if (status == VXM_OK)
    status = measure_bins(band, error);
  vxm_free(band->clusters->context, band->put);
  band->put = NULL;
  return status;
}

/* ---- What it takes ---- */

uint64_t vxm_distance_band_bytes(size_t triangles, int workers, const int64_t dims[3]) {
  uint64_t bins = (uint64_t)tiles_of(dims[1]) * (uint64_t)tiles_of(dims[2]) + 1;
  return sizeof(vxm_distance_band) +
         (uint64_t)workers *
             (sizeof(vxm_band_tile) + sizeof(vxm_distance_tiles) + triangles * sizeof(uint32_t)) +
         bins * sizeof(size_t) + capacity_of(triangles) * sizeof(uint32_t) + 4096;
}

vxm_status vxm_distance_band_create(vxm_distance_band **out, const vxm_band_clusters *clusters, int workers,
                                    vxm_error *error) {
  vxm_context *context = clusters->context;
  const int64_t *dims = clusters->grid.dims;
  vxm_error local = VXM_ERROR_INIT;
  vxm_distance_band *band = vxm_calloc(context, 1, sizeof *band, &local);
  *out = NULL;
  if (band) {
    band->clusters = clusters;
    band->kernels = vxm_band_kernels_best();
    band->workers = workers;
    band->across = tiles_of(dims[0]);
    band->down = tiles_of(dims[1]);
    band->capacity = capacity_of(clusters->count);
    band->tiles = vxm_alloc(context, (size_t)workers, sizeof *band->tiles, &local);
    band->near = vxm_alloc(context, (size_t)workers * clusters->count, sizeof *band->near, &local);
    band->starts =
        vxm_alloc(context, (size_t)(band->down * tiles_of(dims[2])) + 1, sizeof *band->starts, &local);
    band->entries = vxm_alloc(context, band->capacity, sizeof *band->entries, &local);
  }
  if (local.code == VXM_OK)
    *out = band;
  else {
    vxm_distance_band_destroy(band);
    vxm_error_pass(error, &local);
  }
  return local.code;
}

void vxm_distance_band_destroy(vxm_distance_band *band) {
  if (!band)
    return;
  vxm_context *context = band->clusters->context;
  vxm_free(context, band->tiles);
  vxm_free(context, band->near);
  vxm_free(context, band->starts);
  vxm_free(context, band->entries);
  vxm_free(context, band);
}
