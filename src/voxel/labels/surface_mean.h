/* SPDX-License-Identifier: BSD-3-Clause */
/** The mean colour of the surface within each voxel, weighted by area, in linear light. */
#ifndef VXM_VOXEL_LABELS_SURFACE_MEAN_H
#define VXM_VOXEL_LABELS_SURFACE_MEAN_H

#include "voxel/labels/surface_paint.h"
#include "voxmend/grid.h"

/** The sum over the surface within a voxel: colour times area, and area. */
typedef struct vxm_surface_sum {
  double light[3], area;
} vxm_surface_sum;

/** Triangles by the runs of slices along x that they reach into. */
typedef struct vxm_surface_slices {
  const vxm_surface_paint *paint;
  const vxm_space *space;
  size_t run_count;
  uint64_t *first;     /**< of each run, and the end */
  uint32_t *triangles; /**< of a run in ascending order */
} vxm_surface_slices;

/** @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED */
vxm_status vxm_surface_slices_open(vxm_surface_slices *slices, const vxm_surface_paint *paint,
                                   const vxm_space *space, vxm_error *error);
void vxm_surface_slices_close(vxm_surface_slices *slices);

/** Adds the surface within slice i to sums, [y][z] in C order. What lies on the border of two voxels belongs
 * to both, but hardly to the one before it, which it colours only if that holds nothing else. */
void vxm_surface_slices_sum(const vxm_surface_slices *slices, int64_t i, vxm_surface_sum *sums);

#endif
