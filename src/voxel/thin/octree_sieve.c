/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/octree_sieve.h"
#include "voxel/thin/sieve_kernels.h"

#include <math.h>

bool vxm_octree_sieve_of(vxm_octree_sieve *sieve, const vxm_view *view, const vxm_lattice *lattice,
                         const vxm_point corner[3]) {
  double unit = (double)lattice->unit, normal[3];
  if (view->words)
    return false;
  sieve->octree = view->octree;
  for (int a = 0; a < 3; a++) {
    int64_t low = vxm_min(vxm_min(corner[0].at[a], corner[1].at[a]), corner[2].at[a]);
    int64_t high = vxm_max(vxm_max(corner[0].at[a], corner[1].at[a]), corner[2].at[a]);
    if (high - low > VXM_LATTICE_NARROW)
      return false;
    sieve->begin[a] = vxm_lattice_last(lattice, low) - 1;
    sieve->end[a] = vxm_lattice_first(lattice, high) + 2;
    if (sieve->begin[a] <= view->begin[a] || sieve->end[a] >= view->end[a])
      return false;
    for (int k = 0; k < 3; k++)
      sieve->at[k][a] = (double)corner[k].at[a] / unit - 0.5;
  }
  sieve->axis = 0;
  for (int a = 0; a < 3; a++) {
    int u = a < 2 ? a + 1 : 0, v = a > 0 ? a - 1 : 2;
    const double(*p)[3] = (const double(*)[3])sieve->at;
    normal[a] = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
    if (fabs(normal[a]) > fabs(normal[sieve->axis]))
      sieve->axis = a;
  }
  double longest = normal[sieve->axis];
  if (longest == 0)
    return false;
  for (int a = 0; a < 3; a++)
    sieve->slope[a] = normal[a] / longest;
  sieve->sign = longest < 0 ? -1 : 1;
  sieve->kept = vxm_view_kept_bricks(view);
  return true;
}

bool vxm_octree_sieve_search(const vxm_octree_sieve *sieve, int *inner, vxm_unsure_links *unsure) {
  const vxm_sieve_kernels *kernels = vxm_sieve_kernels_of(NULL);
  if (!kernels->search_bricks(sieve, *inner, unsure))
    return false;
  if (kernels->search_bricks(sieve, -*inner, NULL))
    return true;
  *inner = -*inner;
  return false;
}
