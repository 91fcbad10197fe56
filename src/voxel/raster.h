/* SPDX-License-Identifier: BSD-3-Clause */
/** Flipping, in every column of voxel centres that a triangle covers, the first voxel beyond it. Exact. */
#ifndef VXM_VOXEL_RASTER_H
#define VXM_VOXEL_RASTER_H

#include "voxel/lattice.h"

/**
 * The axes of a column raster: columns run along w, and are numbered by u and v. u comes before v in x, y, z,
 * which makes the symbolic perturbation larger along u than along v.
 */
typedef struct vxm_axes {
  int u, v, w;
} vxm_axes;

static inline vxm_axes vxm_axes_of(int axis) {
  return (vxm_axes){axis == 0 ? 1 : 0, axis == 2 ? 1 : 2, axis};
}

/** A box of voxels inside the grid, by the axes of a raster; ends are exclusive. */
typedef struct vxm_box {
  int64_t u_begin, u_end, v_begin, v_end, w_begin, w_end;
} vxm_box;

/** Columns of a row, counted from the box's u_begin, that hold flips; end <= begin if there are none. */
typedef struct vxm_span {
  int32_t begin, end;
} vxm_span;

/**
 * Where the flips go: bits for a box of voxels, x along the words as in the grid, so x positions count from
 * x_first, a multiple of 64. A voxel lies in word
 *   (v - box.v_begin) * v_stride + (u - box.u_begin) * row_words + (w - x_first) / 64   if w is x, otherwise
 *   (v - box.v_begin) * v_stride + (w - box.w_begin) * row_words + (u - x_first) / 64.
 */
typedef struct vxm_raster {
  const vxm_lattice *lattice;
  vxm_axes axes;
  vxm_box box;
  int64_t x_first;
  size_t row_words; /**< words of a row along x */
  size_t v_stride;
  uint64_t *words;
  vxm_span *spans; /**< of every row v of the box */
} vxm_raster;

/**
 * Flips for triangle abc: in each column of the box that it covers, the first voxel whose centre lies beyond
 * it; what lies before the box counts for its first voxel, what lies behind it is left out. A column belongs
 * to exactly one of two triangles that share an edge, also when its centre lies on that edge.
 */
void vxm_raster_triangle(const vxm_raster *raster, const vxm_point *a, const vxm_point *b,
                         const vxm_point *c);

#endif
