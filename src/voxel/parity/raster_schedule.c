/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/raster_schedule.h"
#include "base/threads.h"

#include <math.h>

enum {
  TASKS_PER_THREAD = 8,
  TRIANGLES_MIN = 256, /**< of a task */
  TRIANGLES_MAX = 4096,
  TASK_CROSSINGS = 1 << 21 /**< of a task, estimated, unless one triangle has more */
};

/** Crossings of a round, estimated: 128 MiB where memory is not limited. */
static const double round_most = 1 << 24, round_least = 1 << 16;

double vxm_raster_schedule_round(const vxm_context *context) {
  size_t left = vxm_memory_left(context);
  double share = left == SIZE_MAX ? round_most : (double)left / (8 * sizeof(uint64_t));
  return share > round_most ? round_most : share < round_least ? round_least : share;
}

void vxm_raster_schedule_destroy(vxm_raster_schedule *schedule) {
  vxm_free(schedule->context, schedule->ranges);
  vxm_free(schedule->context, schedule->round_end);
  *schedule = (vxm_raster_schedule){.context = schedule->context};
}

/* ---- Estimates ---- */

/** At least the number of columns of the window that a triangle covers. */
static double estimate(const vxm_raster_schedule *schedule, const vxm_columns *c, size_t f) {
  vxm_point p[3];
  double size[2];
  const int axes[2] = {c->u, c->v};
  for (int k = 0; k < 3; k++)
    p[k] = vxm_snapped_points_at(schedule->placed, schedule->triangles->corners[f][k]);
  for (int i = 0; i < 2; i++) {
    int a = axes[i];
    int64_t low = vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]);
    int64_t high = vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]);
    int64_t first = vxm_max(vxm_lattice_first(&schedule->placed->lattice, low), c->begin[a]);
    int64_t last = vxm_min(vxm_lattice_last(&schedule->placed->lattice, high), c->end[a] - 1);
    if (first > last)
      return 0;
    size[i] = (double)(last - first + 1);
  }
  double bu = (double)(p[1].at[c->u] - p[0].at[c->u]), bv = (double)(p[1].at[c->v] - p[0].at[c->v]);
  double cu = (double)(p[2].at[c->u] - p[0].at[c->u]), cv = (double)(p[2].at[c->v] - p[0].at[c->v]);
  double unit = (double)schedule->placed->lattice.unit;
  double area = fabs(bu * cv - bv * cu) / (2 * unit * unit);
  return fmin(size[0] * size[1], area + 2 * (size[0] + size[1]));
}

static double estimate_all(const vxm_raster_schedule *schedule, size_t f) {
  double sum = 0;
  for (size_t c = 0; c < schedule->columns_count; c++)
    sum += estimate(schedule, &schedule->columns[c], f);
  return sum;
}

/**
 * At least the longest that a unit vector becomes: with the matrix M the square of that is the spectral norm
 * of M^T M, which its largest sum of a row bounds. Nothing is lost where M turns and scales.
 */
static double stretch_of(const double m[12]) {
  double most = 0, total = 0;
  for (int i = 0; i < 3; i++) {
    double sum = 0;
    for (int j = 0; j < 3; j++)
      sum += fabs(m[i] * m[j] + m[4 + i] * m[4 + j] + m[8 + i] * m[8 + j]);
    most = fmax(most, sum);
    total += sum;
  }
  const double rounding = 1 + 0x1p-40;
  return total < INFINITY ? sqrt(most) * rounding : INFINITY; /* also where sums overflow to no number */
}

double vxm_raster_schedule_bound(const vxm_edge_lengths lengths[VXM_LENGTHS_SETS], unsigned roles,
                                 const vxm_space *space, const double transform[12]) {
  double voxel = space->voxel_size[0], bound = 0;
  for (int a = 1; a < 3; a++)
    voxel = fmin(voxel, space->voxel_size[a]);
  double scale = (transform ? stretch_of(transform) : 1) / voxel;
  const bool counts[VXM_LENGTHS_SETS] = {true, (roles & VXM_ROLE_CONE) != 0};
  for (int s = 0; s < VXM_LENGTHS_SETS; s++)
    if (counts[s])
      bound += lengths[s].squared * scale * scale + 2 * lengths[s].sum * scale + lengths[s].count;
  return bound;
}

double vxm_raster_schedule_placed_bound(const vxm_snapped_points *placed, unsigned roles) {
  return vxm_raster_schedule_bound(placed->lengths, roles, &placed->lattice.space, placed->transform);
}

/* ---- Planning ---- */

static vxm_status add_range(vxm_raster_schedule *schedule, size_t begin, size_t end, vxm_error *error) {
  vxm_status status = vxm_grow(schedule->context, (void **)&schedule->ranges, &schedule->range_capacity,
                               schedule->range_count + 1, sizeof *schedule->ranges, error);
  if (status == VXM_OK)
    schedule->ranges[schedule->range_count++] = (vxm_raster_range){begin, end};
  return status;
}

static vxm_status end_round(vxm_raster_schedule *schedule, vxm_error *error) {
  vxm_status status = vxm_grow(schedule->context, (void **)&schedule->round_end, &schedule->round_capacity,
                               schedule->round_count + 1, sizeof *schedule->round_end, error);
  if (status == VXM_OK)
    schedule->round_end[schedule->round_count++] = schedule->range_count;
  return status;
}

/** Equal tasks in one round: enough where no triangle can have many crossings. */
static vxm_status plan_evenly(vxm_raster_schedule *schedule, size_t begin, size_t end, vxm_error *error) {
  size_t shares = (size_t)vxm_context_threads(schedule->context) * TASKS_PER_THREAD;
  size_t step = (end - begin) / shares + 1;
  step = step < TRIANGLES_MIN ? TRIANGLES_MIN : step > TRIANGLES_MAX ? TRIANGLES_MAX : step;
  vxm_status status = VXM_OK;
  for (size_t f = begin; f < end && status == VXM_OK; f += step)
    status = add_range(schedule, f, end - f < step ? end : f + step, error);
  return status == VXM_OK ? end_round(schedule, error) : status;
}

/** Tasks of about equal crossings, and a round after each part with which the crossings become too many. */
static vxm_status plan_by_estimate(vxm_raster_schedule *schedule, size_t begin, size_t end,
                                   vxm_error *error) {
  double task = 0, round = 0, round_crossings = vxm_raster_schedule_round(schedule->context);
  size_t first = begin;
  vxm_status status = VXM_OK;
  for (size_t f = begin; f < end && status == VXM_OK; f++) {
    double crossings = estimate_all(schedule, f);
    bool part_ends = f + 1 == end || schedule->triangles->part[f + 1] != schedule->triangles->part[f];
    task += crossings;
    round += crossings;
    bool round_ends = f + 1 == end || (part_ends && round > round_crossings);
    if (task <= TASK_CROSSINGS && f + 1 - first < TRIANGLES_MAX && !round_ends)
      continue;
    status = add_range(schedule, first, f + 1, error);
    first = f + 1;
    task = 0;
    if (round_ends && status == VXM_OK) {
      status = end_round(schedule, error);
      round = 0;
    }
  }
  return status;
}

vxm_status vxm_raster_schedule_plan(vxm_raster_schedule *schedule, const vxm_triangle_set *triangles,
                                    const vxm_snapped_points *placed, const vxm_columns *columns,
                                    size_t columns_count, vxm_error *error) {
  schedule->triangles = triangles;
  schedule->placed = placed;
  schedule->columns = columns;
  schedule->columns_count = columns_count;
  schedule->range_count = schedule->round_count = 0;
  size_t begin = SIZE_MAX, end = 0;
  double most = 0;
  for (size_t c = 0; c < columns_count; c++) {
    begin = columns[c].triangle_begin < begin ? columns[c].triangle_begin : begin;
    end = columns[c].triangle_end > end ? columns[c].triangle_end : end;
    most += vxm_raster_schedule_placed_bound(placed, columns[c].roles);
  }
  if (begin >= end)
    return end_round(schedule, error);
  /* One part is never divided between rounds; estimates would only share out the work better, which pays
     where few triangles have very many crossings. */
  bool one_part = triangles->part[begin] == triangles->part[end - 1];
  bool sharing = vxm_context_threads(schedule->context) > 1 && end - begin <= TRIANGLES_MAX;
  if (one_part ? !sharing || most <= round_most : most <= vxm_raster_schedule_round(schedule->context))
    return plan_evenly(schedule, begin, end, error);
  return plan_by_estimate(schedule, begin, end, error);
}

/* ---- Running ---- */

typedef struct raster_job {
  const vxm_raster_schedule *schedule;
  const vxm_kernels *kernels;
  vxm_crossing_bins *bins;
  uint64_t *words;
  size_t first; /**< range of the round */
  vxm_task_progress *progress;
} raster_job;

static void raster_range(size_t task, int worker, void *payload) {
  const raster_job *job = payload;
  const vxm_raster_schedule *schedule = job->schedule;
  if (vxm_task_progress_stopped(job->progress, worker))
    return;
  const vxm_raster_range *range = &schedule->ranges[job->first + task];
  vxm_raster_task raster = {.placed = schedule->placed,
                            .triangles = schedule->triangles,
                            .begin = range->begin,
                            .end = range->end,
                            .columns = schedule->columns,
                            .columns_count = schedule->columns_count,
                            .bins = job->bins,
                            .words = job->words,
                            .worker = (size_t)worker};
  job->kernels->raster(&raster);
  vxm_task_progress_step(job->progress);
}

void vxm_raster_schedule_run(const vxm_raster_schedule *schedule, size_t round, vxm_crossing_bins *bins,
                             vxm_task_progress *progress) {
  size_t first = round > 0 ? schedule->round_end[round - 1] : 0;
  raster_job job = {schedule, vxm_kernels_get(), bins, NULL, first, progress};
  vxm_parallel(schedule->context, schedule->round_end[round] - first, raster_range, &job);
}

void vxm_raster_schedule_flip(const vxm_raster_schedule *schedule, uint64_t *words,
                              vxm_task_progress *progress) {
  raster_job job = {schedule, vxm_kernels_get(), NULL, words, 0, progress};
  for (size_t task = 0; task < schedule->range_count; task++)
    raster_range(task, 0, &job);
}
