/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity.h"

#include <string.h>

static void draw_triangle(const vxm_unite_job *job, const vxm_facet *facet, const vxm_raster *raster) {
  const vxm_point *points = job->facets->points;
  vxm_raster_triangle(raster, &points[facet->corner[0]], &points[facet->corner[1]],
                      &points[facet->corner[2]]);
}

/** Prefix XOR within a row of words, for columns along x; the words are cleared. Returns what was set. */
static uint64_t fold_row(uint64_t *words, size_t count, uint64_t *row, uint64_t last_mask, uint64_t *carry) {
  uint64_t any = 0;
  *carry = 0;
  for (size_t w = 0; w < count; w++) {
    uint64_t inside = vxm_prefix_xor(words[w]) ^ *carry;
    *carry = 0 - (inside >> 63);
    words[w] = 0;
    if (w + 1 == count)
      inside &= last_mask;
    row[w] |= inside;
    any |= inside;
  }
  return any;
}

/** Columns along x: every row of the grid is a column. Only rows between the ends of a span hold flips. */
static bool fold_along_x(vxm_grid *grid, const vxm_raster *raster) {
  const vxm_box *box = &raster->box;
  size_t first = (size_t)raster->x_first / 64, end = first + raster->row_words;
  uint64_t any = 0, last_mask = end == grid->row_words ? vxm_grid_tail_mask(grid) : ~UINT64_C(0);
  for (int64_t k = box->v_begin; k < box->v_end; k++) {
    vxm_span *span = &raster->spans[k - box->v_begin];
    uint64_t *plane = raster->words + (size_t)(k - box->v_begin) * raster->v_stride;
    for (int32_t u = span->begin; u < span->end; u++) {
      uint64_t *row = vxm_grid_row(grid, box->u_begin + u, k), carry;
      any |=
          fold_row(plane + (size_t)u * raster->row_words, raster->row_words, row + first, last_mask, &carry);
      if (carry) /* what is left open at the end of the box runs to the end of the row */
        vxm_row_set_span(row, (int64_t)end * 64, grid->space.dims[0]);
    }
    *span = (vxm_span){0, 0};
  }
  return any != 0;
}

/** The words of the grid that scratch row w of slab row v belongs to. */
static uint64_t *grid_row(const vxm_grid *grid, const vxm_raster *raster, int64_t v, int64_t w) {
  bool along_y = raster->axes.w == 1;
  return vxm_grid_row(grid, along_y ? w : v, along_y ? v : w) + raster->x_first / 64;
}

/** Columns along y or z: XOR of row onto row. Only the words of a span hold flips. */
static bool fold_across_rows(vxm_grid *grid, const vxm_raster *raster) {
  const vxm_box *box = &raster->box;
  int64_t w_dim = grid->space.dims[raster->axes.w];
  uint64_t any = 0;
  for (int64_t v = box->v_begin; v < box->v_end; v++) {
    vxm_span *span = &raster->spans[v - box->v_begin];
    if (span->end <= span->begin)
      continue;
    int64_t shift = box->u_begin - raster->x_first;
    size_t first = (size_t)(span->begin + shift) / 64, end = (size_t)(span->end - 1 + shift) / 64 + 1;
    uint64_t *words = raster->words + (size_t)(v - box->v_begin) * raster->v_stride;
    uint64_t *before = NULL, open = 0;
    for (int64_t w = box->w_begin; w < box->w_end; w++, before = words, words += raster->row_words) {
      uint64_t *row = grid_row(grid, raster, v, w);
      open = 0;
      for (size_t i = first; i < end; i++) {
        if (before) {
          words[i] ^= before[i];
          before[i] = 0;
        }
        row[i] |= words[i];
        open |= words[i];
      }
      any |= open;
    }
    /* What is left open at the end of the box runs to the end of the grid. */
    for (int64_t w = box->w_end; open && w < w_dim; w++) {
      uint64_t *row = grid_row(grid, raster, v, w);
      for (size_t i = first; i < end; i++)
        row[i] |= before[i];
    }
    memset(before + first, 0, (end - first) * sizeof *before);
    *span = (vxm_span){0, 0};
  }
  return any != 0;
}

vxm_status vxm_parity_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_error *error) {
  return vxm_unite(grid, job, draw_triangle, job->axes.w == 0 ? fold_along_x : fold_across_rows, error);
}
