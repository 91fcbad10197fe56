/* SPDX-License-Identifier: BSD-3-Clause */
/** Eisemann and Decoret 2008, single-pass solid voxelization: a fragment XORs its column of bits with a mask
 * that has all voxels behind it. Here the column is a row of the grid, and its words are what a render target
 * holds in the paper. */
#include "experimental/columns.h"

static void flip_behind(void *payload, const int64_t voxel[3]) {
  const vxm_baseline_job *job = payload;
  uint64_t *row = vxm_grid_row(job->grid, voxel[1], voxel[2]);
  size_t word = (size_t)voxel[0] / 64;
  job->report->tests++;
  if (word == job->grid->row_words) /* behind the grid */
    return;
  row[word] ^= ~UINT64_C(0) << (voxel[0] % 64);
  for (word++; word < job->grid->row_words; word++)
    row[word] ^= ~UINT64_C(0);
}

vxm_status vxm_baseline_eisemann(const vxm_baseline_job *job, vxm_error *error) {
  vxm_baseline_job flipped = *job;
  vxm_grid *grid = job->grid;
  for (size_t t = 0; t < job->surface->triangle_count; t++) {
    vxm_point p[3];
    vxm_status status = vxm_check_cancelled_at(t, job->context, error);
    if (status != VXM_OK)
      return status;
    vxm_baseline_triangle(p, job, t);
    vxm_for_columns(&job->surface->lattice, p, 0, flip_behind, &flipped);
  }
  for (size_t last = grid->row_words - 1; last < grid->word_count; last += grid->row_words)
    grid->words[last] &= vxm_grid_tail_mask(grid);
  return VXM_OK;
}
