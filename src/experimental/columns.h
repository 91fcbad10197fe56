/* SPDX-License-Identifier: BSD-3-Clause */
/** The columns of voxel centres along an axis that a triangle covers, one by one, exactly. */
#ifndef VXM_EXPERIMENTAL_COLUMNS_H
#define VXM_EXPERIMENTAL_COLUMNS_H

#include "experimental/baseline.h"

/** floor (t / d), d > 0. */
static inline int64_t vxm_floor_quotient(int64_t t, int64_t d) {
  return t / d - (t % d < 0);
}

/**
 * For each column along `axis` within the grid that a triangle covers, calls `cross` with the voxel of the
 * column, within the grid or the one behind it, that is the first beyond the triangle.
 */
static inline void vxm_for_columns(const vxm_lattice *lattice, const vxm_point p[3], int axis,
                                   void (*cross)(void *payload, const int64_t voxel[3]), void *payload) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int64_t unit = lattice->unit, first[2], end[2];
  for (int side = 0; side < 2; side++) {
    int a = side == 0 ? u : v;
    int64_t low = vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]);
    int64_t high = vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]);
    first[side] = vxm_max(vxm_lattice_first(lattice, low), 0);
    end[side] = vxm_min(vxm_lattice_first(lattice, high), lattice->space.dims[a]);
  }
  vxm_projected_64 t =
      vxm_project_64(p[1].at[u] - p[0].at[u], p[1].at[v] - p[0].at[v], p[1].at[axis] - p[0].at[axis],
                     p[2].at[u] - p[0].at[u], p[2].at[v] - p[0].at[v], p[2].at[axis] - p[0].at[axis]);
  if (t.nw == 0)
    return;
  for (int64_t j = first[1]; j < end[1]; j++)
    for (int64_t i = first[0]; i < end[0]; i++) {
      int64_t pu = vxm_lattice_centre(lattice, i) - p[0].at[u];
      int64_t pv = vxm_lattice_centre(lattice, j) - p[0].at[v];
      bool inside = true;
      for (int side = 0; side < 3 && inside; side++)
        inside = vxm_side_of_64(t, side, pu, pv, unit, u < v).value >= 0;
      if (!inside)
        continue;
      vxm_plane_64 plane = vxm_plane_of_64(t, p[0].at[axis], pu, pv, unit, lattice->bits, u, v);
      int64_t at = plane.base + vxm_floor_quotient(plane.across, plane.step), voxel[3];
      voxel[u] = i;
      voxel[v] = j;
      voxel[axis] = vxm_max(vxm_min(at, lattice->space.dims[axis]), 0);
      cross(payload, voxel);
    }
}

#endif
