/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/reach.h"
#include "base/threads.h"
#include "base/watch.h"
#include "voxel/triangle.h"

#include <math.h>

enum {
  TILE_BITS = 4,         /**< a tile has 16 rows of 16 slices, and so 256 KiB where rows have 256 voxels */
  TILE = 1 << TILE_BITS, /**< each is one thread's: no two write the same voxel */
  CHUNK = 1 << 12,       /**< triangles of a task that sorts */
  LISTED_MIN = 1 << 20   /**< triangles listed at once, at least */
};

static inline double least(double a, double b) {
  return a < b ? a : b;
}

static inline double greatest(double a, double b) {
  return a > b ? a : b;
}

vxm_reach vxm_reach_of(const vxm_surface *surface, const vxm_space *space, vxm_layout layout, double band) {
  const double *size = space->voxel_size;
  const int axes[3] = {layout.fast, layout.middle, layout.slow};
  vxm_reach reach = {
      .context = surface->context, .surface = surface, .layout = layout, .side = size[0], .band = band};
  for (int a = 1; a < 3; a++)
    reach.side = size[a] > reach.side ? size[a] : reach.side;
  for (int a = 0; a < 3; a++) {
    reach.origin[a] = space->origin[a];
    reach.step[a] = size[axes[a]] / reach.side;
    reach.dims[a] = space->dims[axes[a]];
  }
  return reach;
}

void vxm_reach_corners(double out[3][3], const vxm_reach *reach, size_t triangle) {
  const int axes[3] = {reach->layout.fast, reach->layout.middle, reach->layout.slow};
  for (int c = 0; c < 3; c++) {
    const double *p = vxm_position(reach->surface->soup, reach->surface->corners[3 * triangle + (size_t)c]);
    for (int a = 0; a < 3; a++)
      out[c][a] = (p[axes[a]] - reach->origin[axes[a]]) / reach->side;
  }
}

double vxm_reach_volume(const vxm_reach *reach) {
  double sum = 0, band = reach->band;
  for (size_t i = 0; i < reach->surface->triangle_count; i++) {
    double corner[3][3], edge[2][3], around = 0, area = 0;
    vxm_reach_corners(corner, reach, i);
    for (int a = 0; a < 3; a++) {
      edge[0][a] = corner[1][a] - corner[0][a];
      edge[1][a] = corner[2][a] - corner[0][a];
    }
    for (int a = 0; a < 3; a++) {
      int b = (a + 1) % 3, c = (a + 2) % 3;
      double n = edge[0][b] * edge[1][c] - edge[0][c] * edge[1][b];
      area += n * n / 4;
      around += fabs(edge[0][a]) + fabs(edge[1][a]);
    }
    /* The prism, three half cylinders and a ball. */
    sum += band * (2 * sqrt(area) + band * (1.6 * around + 4.2 * band));
  }
  return sum / (reach->step[0] * reach->step[1] * reach->step[2]);
}

/* ---- Triangles to tiles ---- */

/** Voxels begin..end-1 along each axis. */
typedef struct box {
  int64_t begin[3], end[3];
} box;

typedef struct scatter {
  const vxm_reach *reach;
  float *values;
  box window;
  size_t across, tile_count;
  atomic_size_t *counters; /**< for each tile triangles, and while listing places in the list */
  size_t *begins;          /**< for each tile of the round where its list begins; one more for the end */
  uint32_t *list;          /**< in any order, which makes no difference to a minimum */
  size_t first, end;       /**< tiles of the round */
  vxm_triangle_row_fn *lower_row;
  vxm_watch watch;
} scatter;

/** The voxels whose centres lie from `low` to `high`, with some more for rounding. */
static void range_of(int64_t *begin, int64_t *end, double low, double high, double step) {
  const double slack = 1e-3;
  low = low / step - 0.5 - slack;
  high = high / step - 0.5 + slack;
  *begin = low > (double)*begin ? (low < (double)*end ? (int64_t)ceil(low) : *end) : *begin;
  *end = high < (double)(*end - 1) ? (high >= (double)*begin ? (int64_t)floor(high) + 1 : *begin) : *end;
}

static bool box_of(box *out, double low[3], double high[3], const scatter *s, const double corner[3][3]) {
  *out = s->window;
  bool is_met = true;
  for (int a = 0; a < 3; a++) {
    low[a] = least(corner[0][a], least(corner[1][a], corner[2][a]));
    high[a] = greatest(corner[0][a], greatest(corner[1][a], corner[2][a]));
    range_of(&out->begin[a], &out->end[a], low[a] - s->reach->band, high[a] + s->reach->band,
             s->reach->step[a]);
    is_met &= out->begin[a] < out->end[a];
  }
  return is_met;
}

/** Counts triangles in tiles, or lists them once there is a list. */
static void sort_chunk(size_t chunk, int worker, void *payload) {
  (void)worker;
  scatter *s = payload;
  size_t count = s->reach->surface->triangle_count, end = (chunk + 1) * CHUNK;
  for (size_t i = chunk * CHUNK; i < (end < count ? end : count); i++) {
    double corner[3][3], low[3], high[3];
    box b;
    vxm_reach_corners(corner, s->reach, i);
    if (!box_of(&b, low, high, s, (const double(*)[3])corner))
      continue;
    size_t left = (size_t)b.begin[1] >> TILE_BITS, right = (size_t)(b.end[1] - 1) >> TILE_BITS,
           top = (size_t)(b.begin[2] - s->window.begin[2]) >> TILE_BITS,
           bottom = (size_t)(b.end[2] - 1 - s->window.begin[2]) >> TILE_BITS;
    for (size_t row = top; row <= bottom; row++)
      for (size_t tile = row * s->across + left; tile <= row * s->across + right; tile++) {
        if (s->list && (tile < s->first || tile >= s->end))
          continue;
        size_t place = atomic_fetch_add_explicit(&s->counters[tile], 1, memory_order_relaxed);
        if (s->list)
          s->list[place] = (uint32_t)i;
      }
  }
}

/* ---- Voxels of a triangle ---- */

/** Cuts low..high to where |from + slope x| (or, one-sided, from + slope x) is at most `most`. */
static bool cut_row(double *low, double *high, double from, double slope, double most, bool is_two_sided) {
  const double slack = 1e-3, flat = 1e-9; /* of all that rounds, and over 2^20 voxels */
  most += slack;
  if (fabs(slope) < flat)
    return is_two_sided ? fabs(from) <= most : from <= most;
  double a = (most - from) / slope, b = (-most - from) / slope;
  if (slope > 0) {
    *high = least(*high, a);
    *low = is_two_sided ? greatest(*low, b) : *low;
  } else {
    *low = greatest(*low, a);
    *high = is_two_sided ? least(*high, b) : *high;
  }
  return *low <= *high + slack;
}

static double square_off(double p, double low, double high) {
  double off = greatest(greatest(low - p, p - high), 0);
  return off * off;
}

/** The points of a row that may be within the band: of the box, the plane, and the sides of the triangle. */
static bool reach_row(double *low, double *high, const vxm_triangle *t, double y, double z, double left,
                      double band) {
  *low -= sqrt(left);
  *high += sqrt(left);
  if (!t->has_inside)
    return true;
  double at[3] = {0, y, z}, from = 0;
  for (int a = 0; a < 3; a++)
    from += (at[a] - t->corner[0][a]) * t->normal[a];
  if (!cut_row(low, high, from, t->normal[0], band, true))
    return false;
  for (int e = 0; e < 3; e++) {
    from = 0;
    for (int a = 0; a < 3; a++)
      from += (at[a] - t->corner[e][a]) * t->side[e][a];
    if (!cut_row(low, high, from, t->side[e][0], band, false))
      return false;
  }
  return true;
}

static void draw_triangle(const scatter *s, const box *tile, size_t triangle) {
  const vxm_reach *reach = s->reach;
  double corner[3][3], low[3], high[3], band2 = reach->band * reach->band;
  box b;
  vxm_triangle t;
  vxm_reach_corners(corner, reach, triangle);
  box_of(&b, low, high, s, (const double(*)[3])corner);
  vxm_triangle_make(&t, (const double(*)[3])corner);
  for (int64_t k = vxm_max(b.begin[2], tile->begin[2]); k < vxm_min(b.end[2], tile->end[2]); k++) {
    double z = ((double)k + 0.5) * reach->step[2], left_z = band2 - square_off(z, low[2], high[2]);
    for (int64_t j = vxm_max(b.begin[1], tile->begin[1]); j < vxm_min(b.end[1], tile->end[1]); j++) {
      double y = ((double)j + 0.5) * reach->step[1], left = left_z - square_off(y, low[1], high[1]);
      double from = low[0], to = high[0];
      if (left < 0 || !reach_row(&from, &to, &t, y, z, left, reach->band))
        continue;
      int64_t begin = 0, end = reach->dims[0];
      range_of(&begin, &end, from, to, reach->step[0]);
      double first[3] = {((double)begin + 0.5) * reach->step[0], y, z};
      float *row = s->values + ((k - s->window.begin[2]) * reach->dims[1] + j) * reach->dims[0];
      s->lower_row(&t, first, reach->step[0], row + begin, end - begin);
    }
  }
}

static void draw_tile(size_t task, int worker, void *payload) {
  scatter *s = payload;
  if (vxm_watch_stopped(&s->watch, worker))
    return;
  size_t tile = s->first + task;
  box b = s->window;
  b.begin[1] = (int64_t)(tile % s->across) << TILE_BITS;
  b.end[1] = vxm_min(b.begin[1] + TILE, b.end[1]);
  b.begin[2] += (int64_t)(tile / s->across) << TILE_BITS;
  b.end[2] = vxm_min(b.begin[2] + TILE, b.end[2]);
  for (size_t i = s->begins[task]; i < s->begins[task + 1]; i++)
    draw_triangle(s, &b, s->list[i]);
  vxm_watch_step(&s->watch);
}

/** Lists as many tiles as keep the list short, though at least one, and draws them. */
static vxm_status do_round(scatter *s, size_t chunks, vxm_error *error) {
  vxm_context *context = s->reach->context;
  size_t most = 4 * s->reach->surface->triangle_count + LISTED_MIN, total = 0;
  for (s->end = s->first; s->end < s->tile_count; s->end++) {
    size_t count = atomic_load_explicit(&s->counters[s->end], memory_order_relaxed);
    if (s->end > s->first && total + count > most)
      break;
    s->begins[s->end - s->first] = total;
    atomic_store_explicit(&s->counters[s->end], total, memory_order_relaxed);
    total += count;
  }
  s->begins[s->end - s->first] = total;
  vxm_error local = VXM_ERROR_INIT;
  s->list = vxm_alloc(context, total, sizeof *s->list, &local);
  if (!s->list) {
    if (error)
      *error = local;
    return local.code;
  }
  if (total > 0) {
    vxm_parallel(context, chunks, sort_chunk, s);
    vxm_parallel(context, s->end - s->first, draw_tile, s);
  }
  vxm_free(context, s->list);
  return s->watch.status;
}

uint64_t vxm_reach_scatter_bytes(size_t triangles, const int64_t dims[3]) {
  uint64_t tiles = ((uint64_t)dims[1] / TILE + 1) * ((uint64_t)dims[2] / TILE + 1);
  return (5 * (uint64_t)triangles + LISTED_MIN) * sizeof(uint32_t) + (tiles + 1) * 2 * sizeof(size_t) + 1024;
}

vxm_status vxm_reach_scatter(const vxm_reach *reach, float *values, int64_t begin, int64_t end,
                             vxm_error *error) {
  scatter s = {
      .reach = reach, .values = values, .window = {{0, 0, begin}, {reach->dims[0], reach->dims[1], end}}};
  s.lower_row = vxm_triangle_row_best();
  size_t chunks = (reach->surface->triangle_count + CHUNK - 1) / CHUNK;
  s.across = (size_t)((reach->dims[1] - 1) >> TILE_BITS) + 1;
  s.tile_count = s.across * ((size_t)((end - begin - 1) >> TILE_BITS) + 1);
  vxm_error local = VXM_ERROR_INIT;
  s.counters = vxm_calloc(reach->context, s.tile_count, sizeof *s.counters, &local);
  s.begins = vxm_alloc(reach->context, s.tile_count + 1, sizeof *s.begins, &local);
  vxm_status status = s.counters && s.begins ? VXM_OK : local.code;
  vxm_watch_start(&s.watch, reach->context, "measuring distances", s.tile_count, &local);
  if (status == VXM_OK)
    vxm_parallel(reach->context, chunks, sort_chunk, &s);
  for (s.first = 0; s.first < s.tile_count && status == VXM_OK; s.first = s.end)
    status = do_round(&s, chunks, &local);
  if (status == VXM_OK)
    status = vxm_watch_end(&s.watch);
  vxm_free(reach->context, s.begins);
  vxm_free(reach->context, s.counters);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

/* ---- Triangles of a voxel ---- */

typedef struct gather {
  const vxm_reach *reach;
  const vxm_nearest *nearest;
  float *values;
  int64_t begin;
  vxm_watch watch;
} gather;

/**
 * One row. A voxel that is farther from all triangles than the band lets as many others go by as lie within
 * the rest: looking a little beyond the band is worth it.
 */
static void gather_row(size_t task, int worker, void *payload) {
  enum { BEYOND = 16 };
  gather *g = payload;
  if (vxm_watch_stopped(&g->watch, worker))
    return;
  const vxm_reach *reach = g->reach;
  int64_t j = (int64_t)task % reach->dims[1], k = (int64_t)task / reach->dims[1];
  double p[3] = {0, ((double)j + 0.5) * reach->step[1], ((double)(g->begin + k) + 0.5) * reach->step[2]};
  double bound = (reach->band + BEYOND) * (reach->band + BEYOND);
  float *row = g->values + (int64_t)task * reach->dims[0];
  size_t triangle = 0;
  for (int64_t i = 0; i < reach->dims[0]; i++) {
    p[0] = ((double)i + 0.5) * reach->step[0];
    double square = vxm_nearest_distance2(g->nearest, p, bound, &triangle);
    row[i] = (float)square < row[i] ? (float)square : row[i];
    double beyond = (sqrt(square) - reach->band) / reach->step[0] - 1e-3;
    i += beyond >= 1 ? (int64_t)beyond : 0;
  }
  vxm_watch_step(&g->watch);
}

vxm_status vxm_reach_gather(const vxm_reach *reach, const vxm_nearest *nearest, float *values, int64_t begin,
                            int64_t end, vxm_error *error) {
  gather g = {.reach = reach, .nearest = nearest, .values = values, .begin = begin};
  size_t rows = (size_t)((end - begin) * reach->dims[1]);
  vxm_watch_start(&g.watch, reach->context, "measuring distances", rows, error);
  vxm_parallel(reach->context, rows, gather_row, &g);
  return vxm_watch_end(&g.watch);
}
