/* SPDX-License-Identifier: BSD-3-Clause */
/** The tests of a triangle against a voxel by Schwarz and Seidel 2010, sections 3.1 and 3.4, set up once for
 * a triangle, in whole numbers. Everything is closed. */
#ifndef VXM_EXPERIMENTAL_TOUCH_H
#define VXM_EXPERIMENTAL_TOUCH_H

#include "experimental/baseline.h"

/** A triangle as voxels are asked about it. */
typedef struct vxm_touch {
  const vxm_lattice *lattice;
  int64_t first[3], end[3]; /**< voxels that meet the box, outside of the grid too */
  int64_t corner[3];        /**< v0 */
  int64_t normal[3];
  int64_t reach;          /**< of a voxel along the normal */
  int dominant;           /**< the axis along which the normal is longest */
  vxm_edge_64 edge[3][3]; /**< by the axis that it is seen along, and by number */
  vxm_point at[3];
} vxm_touch;

void vxm_touch_make(vxm_touch *out, const vxm_lattice *lattice, const vxm_point corners[3], bool thin);

/** From the triangle's first corner to the centre of a voxel, along an axis. */
static inline int64_t vxm_touch_from(const vxm_touch *touch, int64_t voxel, int axis, int corner) {
  return vxm_lattice_centre(touch->lattice, voxel) - touch->at[corner].at[axis];
}

/** Whether the projections along an axis overlap (equation 3). */
static inline bool vxm_touch_seen(const vxm_touch *touch, const int64_t voxel[3], int axis) {
  int p = (axis + 1) % 3, q = (axis + 2) % 3;
  for (int e = 0; e < 3; e++)
    if (vxm_edge_value_64(touch->edge[axis][e], vxm_touch_from(touch, voxel[p], p, e),
                          vxm_touch_from(touch, voxel[q], q, e)) < 0)
      return false;
  return true;
}

/** Whether the plane meets a voxel (equation 1). */
static inline bool vxm_touch_plane(const vxm_touch *touch, const int64_t voxel[3]) {
  int64_t across = 0;
  for (int a = 0; a < 3; a++)
    across += touch->normal[a] * vxm_touch_from(touch, voxel[a], a, 0);
  return (across < 0 ? -across : across) <= touch->reach;
}

/** The voxels of a column along the dominant axis that the plane meets: first to last, not clipped. */
void vxm_touch_depths(const vxm_touch *touch, const int64_t voxel[3], int64_t *first, int64_t *last);

/** Axes along which the box is longer than a voxel. */
static inline int vxm_touch_extent(const vxm_touch *touch) {
  int count = 0;
  for (int a = 0; a < 3; a++)
    count += touch->end[a] - touch->first[a] > 1;
  return count;
}

#endif
