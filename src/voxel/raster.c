/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/raster.h"

static inline void flip(const vxm_raster *raster, int64_t u, int64_t v, int64_t w) {
  const vxm_box *box = &raster->box;
  if (w >= box->w_end)
    return;
  if (w < box->w_begin)
    w = box->w_begin;
  uint64_t *row = raster->words + (size_t)(v - box->v_begin) * raster->v_stride;
  if (raster->axes.w == 0) {
    size_t x = (size_t)(w - raster->x_first);
    row[(size_t)(u - box->u_begin) * raster->row_words + x / 64] ^= UINT64_C(1) << (x % 64);
  } else {
    size_t x = (size_t)(u - raster->x_first);
    row[(size_t)(w - box->w_begin) * raster->row_words + x / 64] ^= UINT64_C(1) << (x % 64);
  }
}

/** Notes that columns u_begin to u_end - 1 of row v may hold flips. */
static inline void widen_span(const vxm_raster *raster, int64_t v, int64_t u_begin, int64_t u_end) {
  vxm_span *span = &raster->spans[v - raster->box.v_begin];
  int32_t begin = (int32_t)(u_begin - raster->box.u_begin), end = (int32_t)(u_end - raster->box.u_begin);
  bool empty = span->end <= span->begin;
  span->begin = empty || begin < span->begin ? begin : span->begin;
  span->end = empty || end > span->end ? end : span->end;
}

/* The same arithmetic twice: in 64 bits for triangles of ordinary size, in 128 bits for the others. */
#define INTEGER int64_t
#define NAME(name) name##_narrow
#include "voxel/raster_body.inc"
#undef INTEGER
#undef NAME

#define INTEGER vxm_int128
#define NAME(name) name##_wide
#include "voxel/raster_body.inc"
#undef INTEGER
#undef NAME

/** Differences up to this keep the narrow products within 63 bits. */
static const int64_t narrow_max = INT64_C(1) << 20;

void vxm_raster_triangle(const vxm_raster *raster, const vxm_point *a, const vxm_point *b,
                         const vxm_point *c) {
  vxm_point low, high;
  for (int k = 0; k < 3; k++) {
    low.at[k] = vxm_min(vxm_min(a->at[k], b->at[k]), c->at[k]);
    high.at[k] = vxm_max(vxm_max(a->at[k], b->at[k]), c->at[k]);
  }
  vxm_axes axes = raster->axes;
  vxm_box rows = raster->box;
  rows.u_begin = vxm_max(rows.u_begin, vxm_lattice_first(raster->lattice, low.at[axes.u]));
  rows.u_end = vxm_min(rows.u_end, vxm_lattice_last(raster->lattice, high.at[axes.u]) + 1);
  rows.v_begin = vxm_max(rows.v_begin, vxm_lattice_first(raster->lattice, low.at[axes.v]));
  rows.v_end = vxm_min(rows.v_end, vxm_lattice_last(raster->lattice, high.at[axes.v]) + 1);
  if (rows.u_begin >= rows.u_end || rows.v_begin >= rows.v_end)
    return; /* between the centres: most triangles of a fine mesh */
  bool narrow = true;
  for (int k = 0; k < 3; k++)
    narrow &= high.at[k] - low.at[k] <= narrow_max;
  if (narrow)
    raster_narrow(raster, a, b, c, rows);
  else
    raster_wide(raster, a, b, c, rows);
}
