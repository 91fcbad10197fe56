/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons into triangles. */
#ifndef VXM_MESH_TRIANGULATE_H
#define VXM_MESH_TRIANGULATE_H

#include "mesh/soup.h"
#include "mesh/spatial_sort.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Room for the largest polygon met so far. */
typedef struct vxm_triangulator {
  vxm_context *context;
  double (*plane)[2];        /**< the corners, with one coordinate left out */
  uint32_t *before, *after;  /**< the ring of corners left */
  vxm_spatial_point *points; /**< the corners in the order of a tree of boxes */
  uint32_t *places;          /**< where in it they are */
  double (*boxes)[2][2];     /**< of its nodes: child n has the children 2 n and 2 n + 1 */
  uint32_t *counts;          /**< of corners left in each node */
  uint32_t *heap, *waits;    /**< corners to be tried, and where in the heap they are */
  double *cuts;              /**< how long a cut it takes to cut them off, squared */
  uint32_t *triangles;       /**< three corners each */
  size_t capacity;
  size_t looks;      /**< at corners and boxes, for all polygons together */
  size_t looks_left; /**< for those that are found to cross themselves */
} vxm_triangulator;

void vxm_triangulator_open(vxm_triangulator *tri, vxm_context *context);
void vxm_triangulator_close(vxm_triangulator *tri);

/**
 * Splits a polygon of n >= 3 corners into n - 2 triangles: one rule for all that needs triangles. One of four
 * corners is cut along a diagonal (mesh/quad_diagonal.h), a larger one by clipping ears, those with the
 * shortest cuts first, seen along the axis on which its vector area is largest; what lies inside is not a
 * matter of rounding. The triangles depend neither on the corner that it begins with nor on the way it is
 * wound; those of a polygon that is turned by right angles or mirrored are turned or mirrored, but where cuts
 * are equally long.
 *
 * A polygon that does not cross itself there is covered once and nothing else is. It may touch itself: holes
 * joined to the rim by an edge there and back, corners on edges, spikes, corners in line. The triangles of
 * one that crosses itself cover all points around which it winds, and others. Either way their boundary is
 * that of the polygon.
 *
 * A polygon of m corners takes some m log m steps; needles side by side with a long row of corners may take
 * m^2 / 64. Those that cross themselves share a budget of work from where that is found; when it is used up
 * what is left of them is halved again and again.
 *
 * @param[out] triangles 3 (n - 2) vertex numbers, valid until the next call
 */
vxm_status vxm_triangulate(vxm_triangulator *tri, const double *positions, const uint32_t *corners, size_t n,
                           const uint32_t **triangles, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
