/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A window is cut into tiles, rows by slices; triangles are sorted into the tiles that they may touch, and
 * each tile is drawn by one task, where it is in the window. Of a window that no cache holds it is drawn in
 * words of its own that stay in cache, and then moved there.
 */
#include "voxel/surface/surface_tiles.h"
#include "base/threads.h"

#include <string.h>

enum {
  TILE_WORDS = 1 << 16,   /**< 512 KiB: within a usual second-level cache */
  LINE_WORDS = 8,         /**< a line of the cache */
  LARGE_WORDS = 1 << 23,  /**< windows that no cache holds: 64 MiB */
  TILES_PER_THREAD = 8,   /**< so that threads end at about the same time */
  CHUNK = 4096,           /**< triangles that one task sorts, at least */
  COUNTERS_MAX = 1 << 20, /**< for all chunks together, unless one chunk needs more */
  LISTED_MIN = 1 << 20,   /**< triangles listed at once, at least */
  MOST = VXM_SURFACE_PLACE_MOST
};

typedef struct tiling {
  const vxm_surface *surface;
  vxm_surface_pen pen; /**< its tile is the whole window, its rows those of all workers */
  bool is_fresh;
  vxm_surface_take_fn take; /**< NULL: tiles go to the window */
  void *payload;
  bool in_place; /**< tiles are drawn in the window itself */
  size_t tile_words;
  vxm_surface_cut cut;
  size_t tile_count;
  size_t chunks;
  size_t *counters;  /**< chunks x tile_count: triangles, and while listing the next place in the list */
  size_t first, end; /**< the tiles that are listed at present */
  size_t *begin;     /**< for each of these where its list begins; one more for the end */
  uint32_t *list;
  uint32_t *places; /**< for each triangle what the first pass found */
  vxm_task_progress progress;
  vxm_error *error;
} tiling;

/* ---- Shape of the tiles ---- */

/** The largest exponent with 2^bits <= n. */
static int log2_floor(int64_t n) {
  int bits = 0;
  while (n >> (bits + 1))
    bits++;
  return bits;
}

/** The smallest exponent with 2^bits >= n. */
static int log2_ceil(int64_t n) {
  return n <= 1 ? 0 : log2_floor(n - 1) + 1;
}

static int least(int a, int b) {
  return a < b ? a : b;
}

/** Cuts the window into tiles of the shape that was chosen. */
static void cut_window(tiling *t) {
  const vxm_window *window = t->pen.window;
  t->cut.across = (size_t)((window->middle_dim - 1) >> t->cut.row_bits) + 1;
  t->tile_count = t->cut.across * ((size_t)((window->end - window->begin - 1) >> t->cut.slice_bits) + 1);
}

static void choose_chunks(tiling *t) {
  size_t most = (size_t)vxm_context_threads(t->surface->context) * 4;
  t->chunks = 1 + t->surface->triangle_count / CHUNK;
  t->chunks = t->chunks < most ? t->chunks : most;
  while (t->chunks > 1 && t->chunks * t->tile_count > COUNTERS_MAX)
    t->chunks--;
}

/** About square, so that few triangles reach over several tiles, but small enough for every thread. */
static void choose_tiles(tiling *t) {
  const vxm_window *window = t->pen.window;
  int64_t slices = window->end - window->begin, rows = window->middle_dim;
  int threads = vxm_context_threads(t->surface->context);
  int64_t fitting = vxm_max(1, TILE_WORDS / (int64_t)window->row_words);
  int64_t shares = threads > 1 ? (int64_t)threads * TILES_PER_THREAD : 1;
  int64_t fair = vxm_max(1, rows * slices / shares);
  int size = log2_floor(vxm_min(fitting, fair));
  t->cut.slice_bits = least(least(size / 2, log2_ceil(slices)), log2_floor(VXM_SURFACE_SLICES));
  t->cut.row_bits = least(size - t->cut.slice_bits, log2_ceil(rows));
  t->in_place = (size_t)slices * window->slice_words < LARGE_WORDS;
  cut_window(t);
}

static vxm_surface_box tile_box(const tiling *t, size_t tile) {
  const vxm_window *window = t->pen.window;
  vxm_surface_box box = t->pen.tile;
  box.begin[VXM_MIDDLE] = (int64_t)(tile % t->cut.across) << t->cut.row_bits;
  box.end[VXM_MIDDLE] = vxm_min(box.begin[VXM_MIDDLE] + (INT64_C(1) << t->cut.row_bits), window->middle_dim);
  box.begin[VXM_SLOW] = window->begin + ((int64_t)(tile / t->cut.across) << t->cut.slice_bits);
  box.end[VXM_SLOW] = vxm_min(box.begin[VXM_SLOW] + (INT64_C(1) << t->cut.slice_bits), window->end);
  return box;
}

/* ---- Sorting triangles into tiles ---- */

/** Counts a triangle in tiles first..end-1 (list NULL), or lists it there. */
static void sort_into(const tiling *t, size_t first, size_t end, size_t *counter, uint32_t *list,
                      uint32_t triangle) {
  first = first > t->first ? first : t->first;
  end = end < t->end ? end : t->end;
  for (size_t tile = first; tile < end; tile++) {
    if (list)
      list[counter[tile]] = triangle;
    counter[tile]++;
  }
}

/** The same for as many tiles from `first` on in each of some bands of slices. */
static void sort_boxed(const tiling *t, size_t first, size_t bands, size_t width, size_t *counter,
                       uint32_t *list, uint32_t triangle) {
  for (size_t b = 0; b < bands; b++, first += t->cut.across)
    sort_into(t, first, first + width, counter, list, triangle);
}

/** A triangle that may be large: in each band of slices only the tiles that it may touch there. */
static void sort_large(const tiling *t, const vxm_point *const v[3], const vxm_surface_box *box,
                       size_t *counter, uint32_t *list, uint32_t triangle) {
  int64_t base = t->pen.window->begin, thickness = INT64_C(1) << t->cut.slice_bits;
  vxm_surface_shadow shadow;
  bool is_wide = (box->end[VXM_MIDDLE] - 1) >> t->cut.row_bits > box->begin[VXM_MIDDLE] >> t->cut.row_bits;
  if (is_wide)
    vxm_surface_shadow_of(&shadow, &t->pen, v);
  int64_t last = (box->end[VXM_SLOW] - 1 - base) >> t->cut.slice_bits;
  for (int64_t band = (box->begin[VXM_SLOW] - base) >> t->cut.slice_bits; band <= last; band++) {
    int64_t s_begin = base + (band << t->cut.slice_bits), begin = box->begin[VXM_MIDDLE],
            end = box->end[VXM_MIDDLE];
    if (is_wide)
      vxm_surface_shadow_rows(&shadow, vxm_max(s_begin, box->begin[VXM_SLOW]),
                              vxm_min(s_begin + thickness, box->end[VXM_SLOW]), &begin, &end);
    if (begin >= end)
      continue;
    size_t row = (size_t)band * t->cut.across;
    sort_into(t, row + (size_t)(begin >> t->cut.row_bits), row + (size_t)((end - 1) >> t->cut.row_bits) + 1,
              counter, list, triangle);
  }
}

/** As a build's place_narrow, of any triangle. */
static uint32_t place_triangle(const tiling *t, const vxm_point *const v[3], vxm_surface_box *box) {
  const vxm_window *window = t->pen.window;
  *box = vxm_surface_bounds_of(t->pen.lattice, window->layout, v).box;
  if (!vxm_surface_meet(box, &t->pen.tile))
    return VXM_SURFACE_PLACE_NONE;
  size_t low = (size_t)(box->begin[VXM_SLOW] - window->begin) >> t->cut.slice_bits;
  size_t high = (size_t)(box->end[VXM_SLOW] - 1 - window->begin) >> t->cut.slice_bits;
  size_t left = (size_t)box->begin[VXM_MIDDLE] >> t->cut.row_bits;
  size_t right = (size_t)(box->end[VXM_MIDDLE] - 1) >> t->cut.row_bits;
  if (high - low >= MOST || right - left >= MOST)
    return VXM_SURFACE_PLACE_LARGE;
  return (uint32_t)(((low * t->cut.across + left) * MOST + (high - low)) * MOST + (right - left));
}

/** The first pass: places of triangles begin..end-1. */
static void place_some(const tiling *t, size_t begin, size_t end) {
  if (!t->surface->wide) {
    t->pen.build->place_narrow(&t->pen, &t->cut, t->places + begin, begin, end);
    return;
  }
  for (size_t i = begin; i < end; i++) {
    const vxm_point *v[3];
    vxm_point copies[3];
    vxm_surface_box box;
    vxm_surface_corners(t->surface, i, v, copies);
    t->places[i] = place_triangle(t, v, &box);
  }
}

/** Counts triangles begin..end-1 in their tiles, or lists them there. */
static void sort_some(const tiling *t, size_t *counter, size_t begin, size_t end) {
  for (size_t i = begin; i < end; i++) {
    uint32_t place = t->places[i];
    if (place == VXM_SURFACE_PLACE_NONE)
      continue;
    if (place == VXM_SURFACE_PLACE_LARGE) {
      const vxm_point *v[3];
      vxm_point copies[3];
      vxm_surface_box box;
      vxm_surface_corners(t->surface, i, v, copies);
      place_triangle(t, v, &box);
      sort_large(t, v, &box, counter, t->list, (uint32_t)i);
    } else
      sort_boxed(t, place / (MOST * MOST), place / MOST % MOST + 1, place % MOST + 1, counter, t->list,
                 (uint32_t)i);
  }
}

static void sort_chunk(size_t chunk, int worker, void *payload) {
  tiling *t = payload;
  size_t end = vxm_slice_begin(t->surface->triangle_count, t->chunks, chunk + 1);
  size_t *counter = t->counters + chunk * t->tile_count;
  for (size_t from = vxm_slice_begin(t->surface->triangle_count, t->chunks, chunk), to; from < end;
       from = to) {
    to = end - from < VXM_CANCEL_STEPS ? end : from + VXM_CANCEL_STEPS;
    if (vxm_task_progress_stopped(&t->progress, worker))
      return;
    if (!t->list)
      place_some(t, from, to);
    sort_some(t, counter, from, to);
  }
}

/**
 * Takes as many tiles from t->first on as keep the list short, though at least one: a triangle as large as
 * the window is listed in every tile, and the list must not outgrow the mesh.
 */
static vxm_status list_tiles(tiling *t) {
  vxm_context *context = t->surface->context;
  size_t most = 4 * t->surface->triangle_count + LISTED_MIN, total = 0;
  for (t->end = t->first; t->end < t->tile_count; t->end++) {
    size_t next = total;
    for (size_t c = 0; c < t->chunks; c++)
      next += t->counters[c * t->tile_count + t->end];
    if (t->end > t->first && next > most)
      break;
    t->begin[t->end - t->first] = total;
    for (size_t c = 0; c < t->chunks; c++) { /* counts become places */
      size_t *counter = &t->counters[c * t->tile_count + t->end], count = *counter;
      *counter = total;
      total += count;
    }
  }
  t->begin[t->end - t->first] = total;
  vxm_free(context, t->list);
  t->list = vxm_alloc(context, total, sizeof *t->list, t->error);
  if (!t->list)
    return t->error->code;
  if (total > 0)
    vxm_parallel(context, t->chunks, sort_chunk, t);
  return t->progress.status;
}

/* ---- Drawing ---- */

/** Moves what was drawn into the window and leaves the tile's words zero. */
static void move_tile(const tiling *t, const vxm_surface_pen *pen) {
  const vxm_surface_box *box = &pen->tile;
  size_t count = (size_t)(box->end[VXM_MIDDLE] - box->begin[VXM_MIDDLE]) * pen->window->row_words;
  for (int64_t s = box->begin[VXM_SLOW]; s < box->end[VXM_SLOW]; s++) {
    uint64_t *to = vxm_window_row(pen->window, box->begin[VXM_MIDDLE], s);
    uint64_t *from = vxm_surface_row(pen, box->begin[VXM_MIDDLE], s);
    if (!t->is_fresh)
      pen->build->join(to, from, count);
    else
      pen->build->put(to, from, count);
  }
}

/** Lets a tile be drawn where it is in the window: nobody else writes its rows. */
static void enter_window(const tiling *t, vxm_surface_pen *pen) {
  const vxm_surface_box *box = &pen->tile;
  const vxm_window *window = pen->window;
  size_t bytes =
      (size_t)(box->end[VXM_MIDDLE] - box->begin[VXM_MIDDLE]) * window->row_words * sizeof *window->words;
  for (int64_t s = box->begin[VXM_SLOW]; s < box->end[VXM_SLOW] && t->is_fresh; s++)
    memset(vxm_window_row(window, box->begin[VXM_MIDDLE], s), 0, bytes);
  pen->words = vxm_window_row(window, box->begin[VXM_MIDDLE], box->begin[VXM_SLOW]);
}

static void draw_tile(size_t task, int worker, void *payload) {
  tiling *t = payload;
  if (t->take && t->begin[task] == t->begin[task + 1]) {
    vxm_task_progress_step(&t->progress);
    return;
  }
  if (vxm_task_progress_stopped(&t->progress, worker))
    return;
  vxm_surface_pen pen = t->pen;
  pen.tile = tile_box(t, t->first + task);
  size_t room = (size_t)1 << t->cut.row_bits, padded = room + (size_t)2 * VXM_SURFACE_LANES;
  pen.rows += (size_t)worker * room;
  pen.row_begin += (size_t)worker * 2 * padded;
  pen.row_end = pen.row_begin + padded;
  if (t->in_place)
    enter_window(t, &pen);
  else
    pen.words += (size_t)worker * t->tile_words;
  if (!vxm_surface_draw_some(&pen, t->list, t->begin[task], t->begin[task + 1], &t->progress, worker))
    return;
  if (t->take)
    t->take(&pen, t->list + t->begin[task], t->begin[task + 1] - t->begin[task], worker, t->payload);
  else if (!t->in_place && (t->is_fresh || t->begin[task] < t->begin[task + 1]))
    move_tile(t, &pen);
  vxm_task_progress_step(&t->progress);
}

/** The tiles of a window, or of a band of its slices. */
static vxm_status draw_tiles(tiling *t) {
  vxm_context *context = t->surface->context;
  t->end = t->tile_count;
  t->first = 0;
  vxm_free(context, t->list);
  t->list = NULL;
  vxm_parallel(context, t->chunks, sort_chunk, t); /* counts only, while there is no list */
  if (t->progress.status != VXM_OK)
    return t->progress.status;
  for (; t->first < t->tile_count; t->first = t->end) {
    vxm_status status = list_tiles(t);
    if (status != VXM_OK)
      return status;
    vxm_parallel(context, t->end - t->first, draw_tile, t);
    if (t->progress.status != VXM_OK)
      return t->progress.status;
  }
  return VXM_OK;
}

/** Room for the tiles, whose shape has been chosen. @return t->error->code */
static vxm_status reserve(tiling *t) {
  vxm_context *context = t->surface->context;
  choose_chunks(t);
  /* Slices a power of two apart would share few sets of the caches. */
  t->pen.slice_words = (t->pen.window->row_words << t->cut.row_bits) + LINE_WORDS;
  t->tile_words = t->pen.slice_words << t->cut.slice_bits;
  size_t workers = (size_t)vxm_context_threads(context), rows = (size_t)1 << t->cut.row_bits;
  t->counters = vxm_calloc(context, t->chunks * t->tile_count, sizeof *t->counters, t->error);
  t->places = vxm_alloc(context, t->surface->triangle_count, sizeof *t->places, t->error);
  t->begin = vxm_alloc(context, t->tile_count + 1, sizeof *t->begin, t->error);
  t->pen.rows = vxm_alloc(context, workers * rows, sizeof *t->pen.rows, t->error);
  t->pen.row_begin = vxm_calloc(context, workers * 2 * (rows + (size_t)2 * VXM_SURFACE_LANES),
                                sizeof *t->pen.row_begin, t->error);
  if (t->in_place)
    t->pen.slice_words = t->pen.window->slice_words;
  else
    t->pen.words = vxm_calloc(context, workers * t->tile_words, sizeof *t->pen.words, t->error);
  return t->error->code;
}

static void release(tiling *t) {
  vxm_context *context = t->surface->context;
  vxm_free(context, t->list);
  vxm_free(context, t->pen.words);
  vxm_free(context, t->pen.row_begin);
  vxm_free(context, t->pen.rows);
  vxm_free(context, t->begin);
  vxm_free(context, t->places);
  vxm_free(context, t->counters);
}

vxm_status vxm_surface_add_tiled(const vxm_surface_pen *pen, bool is_fresh, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  tiling t = {.surface = pen->surface, .pen = *pen, .is_fresh = is_fresh, .error = &local};
  choose_tiles(&t);
  vxm_task_progress_start(&t.progress, pen->surface->context, "voxelizing the surface", t.tile_count, &local);
  vxm_status status = reserve(&t);
  if (status == VXM_OK)
    status = draw_tiles(&t);
  if (status == VXM_OK)
    status = vxm_task_progress_end(&t.progress);
  release(&t);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_surface_take_tiles(const vxm_surface_pen *pen, int bits, vxm_surface_take_fn take,
                                  void *payload, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  tiling t = {.surface = pen->surface, .pen = *pen, .take = take, .payload = payload, .error = &local};
  t.cut.row_bits = t.cut.slice_bits = bits;
  /* Bands of slices, so that counters, one for each tile and chunk, stay few. */
  vxm_window band = *pen->window;
  int64_t across = ((band.middle_dim - 1) >> bits) + 1, all = pen->window->end;
  int64_t slices = vxm_max(1, COUNTERS_MAX / 4 / across) << bits;
  t.pen.window = &band;
  band.end = vxm_min(slices, all);
  cut_window(&t);
  size_t tiles = (size_t)across * ((size_t)((all - 1) >> bits) + 1);
  vxm_task_progress_start(&t.progress, pen->surface->context, "voxelizing the surface", tiles, &local);
  vxm_status status = reserve(&t);
  for (int64_t begin = 0; begin < all && status == VXM_OK; begin += slices) {
    band.begin = t.pen.tile.begin[VXM_SLOW] = begin;
    band.end = t.pen.tile.end[VXM_SLOW] = vxm_min(begin + slices, all);
    cut_window(&t);
    memset(t.counters, 0, t.chunks * t.tile_count * sizeof *t.counters);
    status = draw_tiles(&t);
  }
  if (status == VXM_OK)
    status = vxm_task_progress_end(&t.progress);
  release(&t);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
