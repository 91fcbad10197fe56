/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity.h"

#include <string.h>

static void draw_triangle(const vxm_unite_job *job, const vxm_facet *facet, vxm_scratch *scratch) {
  const vxm_point *points = job->facets->points;
  vxm_raster_triangle(&scratch->raster, &points[facet->corner[0]], &points[facet->corner[1]],
                      &points[facet->corner[2]]);
}

/** Prefix XOR within rows, for columns along x. What is left open at the end of the box runs to the end of
 * the row. */
static bool fold_along_x(vxm_grid *grid, vxm_scratch *s) {
  const vxm_box *box = &s->raster.box;
  size_t first = (size_t)s->raster.x_first / 64;
  uint64_t any = 0, *words = s->raster.words;
  for (int64_t k = box->v_begin; k < box->v_end; k++)
    for (int64_t j = box->u_begin; j < box->u_end; j++) {
      uint64_t *row = vxm_grid_row(grid, j, k), carry = 0, seen = 0;
      for (size_t w = 0; w < s->row_words; w++) {
        uint64_t inside = vxm_prefix_xor(words[w]) ^ carry;
        carry = 0 - (inside >> 63);
        words[w] = 0;
        if (first + w + 1 == grid->row_words)
          inside &= vxm_grid_tail_mask(grid);
        row[first + w] |= inside;
        seen |= inside;
      }
      words += s->row_words;
      if (carry)
        vxm_row_set_span(row, (int64_t)(first + s->row_words) * 64, grid->space.dims[0]);
      any |= seen;
    }
  return any != 0;
}

/** The grid row that scratch row w of slab row v belongs to. */
static uint64_t *grid_row(const vxm_grid *grid, const vxm_scratch *s, int64_t v, int64_t w) {
  bool along_y = s->raster.axes.w == 1;
  return vxm_grid_row(grid, along_y ? w : v, along_y ? v : w) + s->raster.x_first / 64;
}

/** XOR of row onto row, for columns along y or z. */
static bool fold_across_rows(vxm_grid *grid, vxm_scratch *s) {
  const vxm_box *box = &s->raster.box;
  int64_t w_dim = grid->space.dims[s->raster.axes.w];
  size_t n = s->row_words;
  uint64_t any = 0;
  for (int64_t v = box->v_begin; v < box->v_end; v++) {
    uint64_t *words = s->raster.words + (size_t)(v - box->v_begin) * s->raster.v_stride;
    uint64_t open = 0;
    uint64_t *before = NULL;
    for (int64_t w = box->w_begin; w < box->w_end; w++, before = words, words += n) {
      uint64_t *row = grid_row(grid, s, v, w);
      open = 0;
      for (size_t i = 0; i < n; i++) {
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
      uint64_t *row = grid_row(grid, s, v, w);
      for (size_t i = 0; i < n; i++)
        row[i] |= before[i];
    }
    memset(before, 0, n * sizeof *before);
  }
  return any != 0;
}

vxm_status vxm_parity_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_error *error) {
  return vxm_unite(grid, job, draw_triangle, job->axes.w == 0 ? fold_along_x : fold_across_rows, error);
}
