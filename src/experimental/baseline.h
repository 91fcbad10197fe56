/* SPDX-License-Identifier: BSD-3-Clause */
/** Published methods as plainly as they can be written, for comparison: what they share. */
#ifndef VXM_EXPERIMENTAL_BASELINE_H
#define VXM_EXPERIMENTAL_BASELINE_H

#include "base/clock.h"
#include "voxel/surface/surface.h"
#include "voxmend/experimental.h"

/** What a method works on: triangles on the lattice of a grid, none of them longer than VXM_LATTICE_NARROW.
 */
typedef struct vxm_baseline_job {
  vxm_context *context;
  vxm_grid *grid; /**< all bits clear at first */
  const vxm_surface *surface;
  const vxm_baseline_options *options;
  vxm_baseline_report *report; /**< methods fill in what they count, and setup_ms */
} vxm_baseline_job;

static inline void vxm_baseline_triangle(vxm_point corners[3], const vxm_baseline_job *job, size_t triangle) {
  for (int c = 0; c < 3; c++)
    corners[c] = vxm_surface_at(job->surface, job->surface->corners[3 * triangle + (size_t)c]);
}

static inline void vxm_baseline_set(vxm_grid *grid, const int64_t voxel[3]) {
  vxm_grid_row(grid, voxel[1], voxel[2])[voxel[0] / 64] |= UINT64_C(1) << (voxel[0] % 64);
}

/** A block of the context that counts in the report; NULL without memory. */
static inline void *vxm_baseline_block(const vxm_baseline_job *job, size_t count, size_t size,
                                       vxm_error *error) {
  void *block = vxm_calloc(job->context, count, size, error);
  job->report->bytes += block ? (uint64_t)count * size : 0;
  return block;
}

/* A method replaces the clear bits of the grid; `error` is not NULL. Each returns VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. */
vxm_status vxm_baseline_axes(const vxm_baseline_job *job, vxm_error *error);
vxm_status vxm_baseline_tetra(const vxm_baseline_job *job, vxm_error *error);
vxm_status vxm_baseline_density(const vxm_baseline_job *job, vxm_error *error);
vxm_status vxm_baseline_boxes(const vxm_baseline_job *job, vxm_error *error);
vxm_status vxm_baseline_zhang(const vxm_baseline_job *job, vxm_error *error);
vxm_status vxm_baseline_eisemann(const vxm_baseline_job *job, vxm_error *error);

/** Runs a method into a grid; the options have been checked. `report` is filled. */
vxm_status vxm_baseline_run(vxm_grid *grid, vxm_baseline_report *report, const vxm_soup *soup,
                            const vxm_baseline_options *options, vxm_error *error);

#endif
