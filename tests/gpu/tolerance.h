/* SPDX-License-Identifier: BSD-3-Clause */
/** How far a voxel that two grids disagree on is from the surface. */
#ifndef TEST_GPU_TOLERANCE_H
#define TEST_GPU_TOLERANCE_H

#include "grid/bitgrid.h"
#include "mesh/soup.h"

#include <math.h>

/** The least distance, in voxels, from the centre of a voxel to the faces of a soup; polygons count as fans.
 */
double distance_of(const vxm_soup *soup, const vxm_space *space, const int64_t at[3]);

typedef struct difference {
  int64_t count;
  double farthest; /**< in voxels; of the first few that were looked at */
} difference;

static inline difference differ(const vxm_grid *a, const vxm_grid *b, const vxm_soup *soup) {
  enum { LOOKED_AT = 40 };
  difference found = {0, 0};
  const int64_t *dims = a->space.dims;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++) {
        if (vxm_grid_get(a, i, j, k) == vxm_grid_get(b, i, j, k))
          continue;
        if (found.count++ < LOOKED_AT)
          found.farthest = fmax(found.farthest, distance_of(soup, &a->space, (int64_t[3]){i, j, k}));
      }
  return found;
}

#endif
