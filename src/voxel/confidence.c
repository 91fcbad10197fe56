/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/confidence.h"
#include "base/threads.h"

#include <string.h>

typedef struct confidence_job {
  uint8_t *confidence;
  const vxm_grid *grid, *closed, *settled;
  vxm_grid *const *voters;
} confidence_job;

static bool bit(const uint64_t *row, int64_t i) {
  return row[i / 64] >> (i % 64) & 1;
}

static void fill_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const confidence_job *job = payload;
  const int64_t *dims = job->grid->space.dims;
  int64_t k = (int64_t)slice;
  for (int64_t j = 0; j < dims[1]; j++) {
    uint8_t *out = job->confidence + (k * dims[1] + j) * dims[0];
    const uint64_t *result = vxm_grid_row(job->grid, j, k), *closed = vxm_grid_row(job->closed, j, k);
    const uint64_t *settled = job->settled ? vxm_grid_row(job->settled, j, k) : NULL;
    for (int64_t i = 0; i < dims[0]; i++) {
      int agree = 0;
      for (int v = 0; v < 4; v++)
        agree += (bit(closed, i) || bit(vxm_grid_row(job->voters[v], j, k), i)) == bit(result, i);
      if (!settled || !bit(settled, i))
        out[i] = (uint8_t)(255 * agree / 4);
    }
  }
}

void vxm_confidence_fill(uint8_t *confidence, const vxm_grid *grid, const vxm_grid *closed,
                         vxm_grid *const voters[4], const vxm_grid *settled) {
  const int64_t *dims = grid->space.dims;
  if (!voters) {
    memset(confidence, 255, (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2]);
    return;
  }
  confidence_job job = {confidence, grid, closed, settled, voters};
  vxm_parallel(grid->context, (size_t)dims[2], fill_slice, &job);
}
