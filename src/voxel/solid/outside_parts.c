/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/outside_parts.h"

#include "base/bits.h"

bool vxm_part_is_outside(const vxm_voxel_pass *pass, size_t part) {
  const vxm_triangle_set *triangles = &pass->analysis->triangles;
  const vxm_part *p = &triangles->parts[part];
  const vxm_lattice *lattice = &pass->placed.lattice;
  int64_t least[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, most[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
  for (size_t f = p->begin; f < p->caps; f++)
    for (size_t c = 0; c < 3; c++) {
      vxm_point point = vxm_snapped_points_at(&pass->placed, triangles->corners[f][c]);
      for (int a = 0; a < 3; a++) {
        least[a] = vxm_min(least[a], point.at[a]);
        most[a] = vxm_max(most[a], point.at[a]);
      }
    }
  for (int a = 0; a < 3 && p->begin < p->caps; a++) {
    int64_t end = lattice->space.dims[a] * lattice->unit, half = lattice->unit / 2;
    bool before = most[a] < 0 || (most[a] == 0 && least[a] < 0) || (most[a] < half && least[a] < -half);
    bool behind = least[a] > end || (least[a] == end && most[a] > end) ||
                  (least[a] > end - half && most[a] > end + half);
    if (before || behind)
      return true;
  }
  return false;
}
