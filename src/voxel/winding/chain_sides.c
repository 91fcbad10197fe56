/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/chain_sides.h"

#include <string.h>

/** Of a triangle whose normal's sign along the rows is `side`. There is room for one more. */
static inline void put(vxm_chain_sides *to, const uint32_t corners[3], int side, bool mirrored) {
  /* Into both places, of which one at most is kept: a branch would be predicted wrongly every other time. */
  memcpy(to->corners[to->entered], corners, sizeof *to->corners);
  memcpy(to->corners[to->left - 1], corners, sizeof *to->corners);
  to->entered += mirrored ? side > 0 : side < 0;
  to->left -= mirrored ? side < 0 : side > 0;
}

static inline int64_t extent(int64_t a, int64_t b, int64_t c) {
  int64_t low = vxm_min(vxm_min(a, b), c), high = vxm_max(vxm_max(a, b), c);
  return high - low;
}

/** The place of a cell along an axis. */
static inline int64_t cell_at(uint64_t cell, int axis) {
  return (int64_t)(cell >> (VXM_CELL_BITS * axis) & vxm_cell_mask(0));
}

static void sort_narrow(vxm_chain_sides *to, const vxm_winding_chain *chain, const vxm_snapped_points *placed,
                        int axis, bool mirrored) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (size_t t = 0; t < chain->closed_count; t++) {
    const uint32_t *corner = chain->closed[t];
    const int32_t *a = placed->narrow[corner[0]], *b = placed->narrow[corner[1]],
                  *c = placed->narrow[corner[2]];
    uint64_t cell[3] = {placed->cells[corner[0]], placed->cells[corner[1]], placed->cells[corner[2]]};
    int64_t rows = extent(cell_at(cell[0], u), cell_at(cell[1], u), cell_at(cell[2], u)) *
                   extent(cell_at(cell[0], v), cell_at(cell[1], v), cell_at(cell[2], v));
    int64_t forth = (int64_t)(b[u] - a[u]) * (c[v] - a[v]), back = (int64_t)(b[v] - a[v]) * (c[u] - a[u]);
    int side = (forth > back) - (forth < back);
    put(to, corner, rows > 0 ? side : 0, mirrored);
    to->rows += (double)rows;
  }
}

/** Rows that a triangle's box covers. */
static double rows_of(const vxm_snapped_points *placed, const vxm_point p[3], int axis) {
  double rows = 1;
  for (int i = 1; i < 3; i++) {
    int a = (axis + i) % 3;
    int64_t most = placed->lattice.space.dims[a] * placed->lattice.unit;
    int64_t low = vxm_max(vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]), 0);
    int64_t high = vxm_min(vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]), most);
    rows *= low <= high ? (double)(high - low) / (double)placed->lattice.unit + 1 : 0;
  }
  return rows;
}

static void sort_wide(vxm_chain_sides *to, const vxm_winding_chain *chain, const vxm_snapped_points *placed,
                      int axis, bool mirrored) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (size_t t = 0; t < chain->closed_count; t++) {
    vxm_point p[3];
    for (int k = 0; k < 3; k++)
      p[k] = vxm_snapped_points_at(placed, chain->closed[t][k]);
    vxm_int128 forth = (vxm_int128)(p[1].at[u] - p[0].at[u]) * (p[2].at[v] - p[0].at[v]),
               back = (vxm_int128)(p[1].at[v] - p[0].at[v]) * (p[2].at[u] - p[0].at[u]);
    put(to, chain->closed[t], (forth > back) - (forth < back), mirrored);
    to->rows += rows_of(placed, p, axis);
  }
}

vxm_chain_sides vxm_chain_sides_sort(uint32_t (*corners)[3], const vxm_winding_chain *chain,
                                     const vxm_snapped_points *placed, int axis, bool mirrored) {
  vxm_chain_sides sides = {.corners = corners, .left = chain->closed_count};
  if (placed->wide)
    sort_wide(&sides, chain, placed, axis, mirrored);
  else
    sort_narrow(&sides, chain, placed, axis, mirrored);
  return sides;
}
