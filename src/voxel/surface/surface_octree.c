/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Triangles are sorted into tiles of one or more strips of nodes (Schwarz & Seidel 2010, section 5.1, sort
 * them into the nodes of the lowest level); what is drawn there becomes nodes at once. Of a tile's rows only
 * the words between the ends of each triangle in it are looked at and cleared.
 */
#include "voxel/surface/surface_octree.h"
#include "voxel/surface/surface_tiles.h"

#include <math.h>
#include <string.h>

enum {
  TILE_WORDS = 1 << 16, /**< 512 KiB; of wider grids a tile has one strip, but most of it is never touched */
  STRIP_BITS = 4,       /**< a strip has 2^4 rows of 2^4 slices */
  TILE_BITS = 6         /**< at most VXM_SURFACE_SLICES */
};

typedef struct octree_job {
  vxm_octree_builder builder;
  uint64_t *touched; /**< for each worker a bit for each word of a row */
  size_t masks;      /**< words of these bits */
} octree_job;

/* ---- Where a triangle is in a tile ---- */

/** Corners of what is left of a triangle once four planes have cut it. */
typedef struct polygon {
  double at[7][3];
  int count;
} polygon;

/** Leaves what is at or beyond a place along an axis, or with sign -1 at or before it. */
static void cut_at(polygon *p, int axis, double place, double sign) {
  polygon kept = {.count = 0};
  for (int c = 0; c < p->count; c++) {
    const double *a = p->at[c], *b = p->at[(c + 1) % p->count];
    double from = sign * (a[axis] - place), to = sign * (b[axis] - place);
    if (from >= 0)
      memcpy(kept.at[kept.count++], a, sizeof kept.at[0]);
    if ((from >= 0) == (to >= 0))
      continue;
    for (int k = 0; k < 3; k++)
      kept.at[kept.count][k] = a[k] + (b[k] - a[k]) * (from / (from - to));
    kept.count++;
  }
  *p = kept;
}

/**
 * Narrows the voxels along x in which a triangle's voxels in the tile may lie. Coordinates are less than 2^40
 * and exact as doubles, and so are their differences; a voxel more on all sides is far more than is rounded.
 */
static void narrow(vxm_surface_box *box, const vxm_surface_box *tile, const vxm_point *const v[3],
                   const vxm_lattice *lattice) {
  polygon p = {.count = 3};
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      p.at[c][a] = (double)v[c]->at[a] / (double)lattice->unit;
  for (int a = VXM_MIDDLE; a <= VXM_SLOW; a++) {
    cut_at(&p, a, (double)(tile->begin[a] - 1), 1);
    cut_at(&p, a, (double)(tile->end[a] + 1), -1);
  }
  double low = INFINITY, high = -INFINITY;
  for (int c = 0; c < p.count; c++) {
    low = fmin(low, p.at[c][0]);
    high = fmax(high, p.at[c][0]);
  }
  if (low > high) /* beside the tile */
    box->end[VXM_FAST] = box->begin[VXM_FAST];
  else {
    box->begin[VXM_FAST] = vxm_max(box->begin[VXM_FAST], (int64_t)floor(low) - 1);
    box->end[VXM_FAST] = vxm_min(box->end[VXM_FAST], (int64_t)floor(high) + 2);
  }
}

/** Marks the words of rows that a triangle may touch. */
static void mark(uint64_t *touched, const vxm_surface_pen *pen, uint32_t triangle) {
  const vxm_point *v[3];
  vxm_point copies[3];
  vxm_surface_corners(pen->surface, triangle, v, copies);
  vxm_surface_box box = vxm_surface_bounds_of(pen->lattice, pen->window->layout, v).box;
  if (!vxm_surface_meet(&box, &pen->tile))
    return;
  if (box.begin[VXM_FAST] / 64 != (box.end[VXM_FAST] - 1) / 64)
    narrow(&box, &pen->tile, v, pen->lattice);
  if (box.begin[VXM_FAST] < box.end[VXM_FAST])
    vxm_row_set_span(touched, box.begin[VXM_FAST] / 64, (box.end[VXM_FAST] - 1) / 64 + 1);
}

/* ---- From tiles to strips ---- */

/** The next run of marked words from a word on; false if there is none. */
static bool next_run(const uint64_t *touched, size_t words, size_t *begin, size_t *end) {
  size_t at = *begin;
  while (at < words && !(touched[at / 64] >> at % 64 & 1))
    at = touched[at / 64] >> at % 64 ? at + (size_t)__builtin_ctzll(touched[at / 64] >> at % 64)
                                     : (at / 64 + 1) * 64;
  if (at >= words)
    return false;
  *begin = at;
  while (at < words && touched[at / 64] >> at % 64 & 1)
    at++;
  *end = at;
  return true;
}

/** Adds what a strip of the tile has in the words marked. */
static void take_strip(octree_job *job, const vxm_surface_pen *pen, const uint64_t *touched, size_t worker,
                       int64_t y, int64_t z) {
  vxm_strip_rows rows = {.words = vxm_surface_row(pen, y, z),
                         .row_words = pen->window->row_words,
                         .slice_words = pen->slice_words};
  rows.y_count = (int)vxm_min(VXM_STRIP_VOXELS, pen->tile.end[VXM_MIDDLE] - y);
  rows.z_count = (int)vxm_min(VXM_STRIP_VOXELS, pen->tile.end[VXM_SLOW] - z);
  for (size_t begin = 0, end = 0; next_run(touched, rows.row_words, &begin, &end); begin = end)
    vxm_strip_add_words(&job->builder, worker, &rows, begin, end);
  vxm_strip_end(&job->builder, worker, (size_t)y / VXM_STRIP_VOXELS, (size_t)z / VXM_STRIP_VOXELS);
}

static void clear_words(const vxm_surface_pen *pen, const uint64_t *touched) {
  for (size_t begin = 0, end = 0; next_run(touched, pen->window->row_words, &begin, &end); begin = end)
    for (int64_t z = pen->tile.begin[VXM_SLOW]; z < pen->tile.end[VXM_SLOW]; z++)
      for (int64_t y = pen->tile.begin[VXM_MIDDLE]; y < pen->tile.end[VXM_MIDDLE]; y++)
        memset(vxm_surface_row(pen, y, z) + begin, 0, (end - begin) * sizeof *pen->words);
}

static void take_tile(const vxm_surface_pen *pen, const uint32_t *list, size_t count, int worker,
                      void *payload) {
  octree_job *job = payload;
  uint64_t *touched = job->touched + (size_t)worker * job->masks;
  memset(touched, 0, job->masks * sizeof *touched);
  for (size_t i = 0; i < count; i++)
    mark(touched, pen, list[i]);
  const vxm_surface_box *tile = &pen->tile;
  for (int64_t z = tile->begin[VXM_SLOW]; z < tile->end[VXM_SLOW]; z += VXM_STRIP_VOXELS)
    for (int64_t y = tile->begin[VXM_MIDDLE]; y < tile->end[VXM_MIDDLE]; y += VXM_STRIP_VOXELS)
      take_strip(job, pen, touched, (size_t)worker, y, z);
  clear_words(pen, touched);
}

static int tile_bits(const vxm_window *window) {
  int bits = STRIP_BITS;
  while (bits < TILE_BITS && window->row_words << 2 * (bits + 1) <= TILE_WORDS)
    bits++;
  return bits;
}

vxm_status vxm_surface_octree(vxm_sparse **out, const vxm_surface *surface, vxm_surface_kind kind,
                              vxm_error *error) {
  vxm_context *context = surface->context;
  const vxm_space *space = &surface->lattice.space;
  vxm_window window = vxm_window_of(space, (vxm_layout)VXM_LAYOUT_GRID, 0, space->dims[2]);
  vxm_surface_pen pen = vxm_surface_pen_of(surface, &window, kind);
  octree_job job = {.masks = (window.row_words + 63) / 64};
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  vxm_status status = vxm_octree_builder_create(&job.builder, context, space, &local);
  if (status == VXM_OK)
    job.touched =
        vxm_alloc(context, (size_t)vxm_context_threads(context) * job.masks, sizeof *job.touched, &local);
  if (status == VXM_OK && job.touched)
    status = vxm_surface_take_tiles(&pen, tile_bits(&window), take_tile, &job, &local);
  if (local.code == VXM_OK)
    status = vxm_octree_builder_check(&job.builder, &local);
  if (local.code == VXM_OK)
    status = vxm_octree_builder_end(out, &job.builder, &local);
  vxm_free(context, job.touched);
  vxm_octree_builder_destroy(&job.builder);
  if (local.code == VXM_OK)
    return status;
  vxm_error_pass(error, &local);
  return local.code;
}
