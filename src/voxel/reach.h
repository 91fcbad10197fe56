/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Squared distances to triangles in a window of a voxel space, lengths counted in the longest side of a
 * voxel, axes in the order of the window: along a row, from row to row, from slice to slice.
 */
#ifndef VXM_VOXEL_REACH_H
#define VXM_VOXEL_REACH_H

#include "voxel/nearest.h"
#include "voxel/surface.h"

/** Triangles seen from a space. */
typedef struct vxm_reach {
  vxm_context *context;
  const vxm_surface *surface;
  vxm_layout layout;
  double origin[3]; /**< model units, in the order of x, y and z */
  double side;      /**< the longest of a voxel, model units */
  double step[3];   /**< from one voxel to the next, in the order of the window */
  int64_t dims[3];
  double band; /**< in `side`; INFINITY = none */
} vxm_reach;

vxm_reach vxm_reach_of(const vxm_surface *surface, const vxm_space *space, vxm_layout layout, double band);

/** The corners of a triangle. */
void vxm_reach_corners(double out[3][3], const vxm_reach *reach, size_t triangle);

/** A bound of the voxels in reach of all triangles, one reached from several counted as often. */
double vxm_reach_volume(const vxm_reach *reach);

/**
 * Lowers squared distances to those of the triangles, where they are within the band: each triangle looks for
 * its voxels. Time follows surface times band.
 *
 * @param values of slices begin..end-1
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_reach_scatter(const vxm_reach *reach, float *values, int64_t begin, int64_t end,
                             vxm_error *error);
/** What vxm_reach_scatter takes at most. */
uint64_t vxm_reach_scatter_bytes(size_t triangles, const int64_t dims[3]);

/** The same where each voxel looks for its triangle: for wide bands, or none. */
vxm_status vxm_reach_gather(const vxm_reach *reach, const vxm_nearest *nearest, float *values, int64_t begin,
                            int64_t end, vxm_error *error);

#endif
