/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The crossings of triangles with columns, put into bins by all threads: in one round, or in several where
 * the bins would take too much memory. A part is always wholly in one round.
 */
#ifndef VXM_VOXEL_PARITY_RASTER_SCHEDULE_H
#define VXM_VOXEL_PARITY_RASTER_SCHEDULE_H

#include "base/task_progress.h"
#include "voxel/parity/kernels.h"

/** Triangles begin..end-1, for one task. */
typedef struct vxm_raster_range {
  size_t begin, end;
} vxm_raster_range;

typedef struct vxm_raster_schedule {
  vxm_context *context;
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  const vxm_columns *columns; /**< of the voters, over the same triangles */
  size_t columns_count;
  vxm_raster_range *ranges;
  size_t range_count, range_capacity;
  size_t *round_end; /**< per round: the range behind its last one */
  size_t round_count, round_capacity;
} vxm_raster_schedule;

/**
 * Plans the tasks and rounds, with the memory of the plan before. Start from {.context = ...}.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_raster_schedule_plan(vxm_raster_schedule *schedule, const vxm_triangle_set *triangles,
                                    const vxm_snapped_points *placed, const vxm_columns *columns,
                                    size_t columns_count, vxm_error *error);
/** Crossings after which a round ends with the present part: a share of the memory that is left. */
double vxm_raster_schedule_round(const vxm_context *context);
/**
 * At least the number of columns along any one axis that triangles of some roles cover: squares about their
 * longest edges, which a transform, or NULL, makes longer.
 */
double vxm_raster_schedule_bound(const vxm_edge_lengths lengths[VXM_LENGTHS_SETS], unsigned roles,
                                 const vxm_space *space, const double transform[12]);
/** The same of triangles as they lie in their space. */
double vxm_raster_schedule_placed_bound(const vxm_snapped_points *placed, unsigned roles);
void vxm_raster_schedule_destroy(vxm_raster_schedule *schedule);

/** Puts the crossings of a round into the bins, which are empty and have a worker for each thread. */
void vxm_raster_schedule_run(const vxm_raster_schedule *schedule, size_t round, vxm_crossing_bins *bins,
                             vxm_task_progress *progress);
/** Flips the words of a window at each crossing of one part, in a context of one thread (see
 * vxm_raster_task). */
void vxm_raster_schedule_flip(const vxm_raster_schedule *schedule, uint64_t *words,
                              vxm_task_progress *progress);

#endif
