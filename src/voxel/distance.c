/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/distance.h"
#include "base/threads.h"
#include "voxel/reach.h"

#include <math.h>

enum { ROWS_PER_TASK = 64 };

/** What a worker has seen of the values, on a line of the cache of its own. */
typedef struct tally {
  _Alignas(64) int64_t exact, inside;
  float least, greatest;
} tally;

typedef struct measure {
  vxm_model *model;
  vxm_reach reach;
  vxm_nearest *nearest; /**< NULL = triangles look for voxels */
  bool is_signed;
  float most2, most; /**< the band, squared and counted as in `reach`, and in model units */
  vxm_window solid;  /**< its words NULL without a sign */
  float *values;     /**< of the slices at hand */
  int64_t rows;
  tally *tallies;
} measure;

/* ---- Values ---- */

static void start_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const measure *m = payload;
  int64_t length = m->reach.dims[0], end = vxm_min(((int64_t)task + 1) * ROWS_PER_TASK, m->rows) * length;
  for (int64_t i = (int64_t)task * ROWS_PER_TASK * length; i < end; i++)
    m->values[i] = m->most2;
}

/** From a squared distance to a value. */
static inline float value_of(const measure *m, float square, bool is_inside) {
  float value = square < m->most2 ? (float)(sqrt((double)square) * m->reach.side) : m->most;
  return is_inside ? -value : value;
}

static void finish_rows(size_t task, int worker, void *payload) {
  const measure *m = payload;
  tally t = m->tallies[worker];
  int64_t length = m->reach.dims[0], end = vxm_min(((int64_t)task + 1) * ROWS_PER_TASK, m->rows);
  for (int64_t row = (int64_t)task * ROWS_PER_TASK; row < end; row++) {
    const uint64_t *bits = m->solid.words ? m->solid.words + (size_t)row * m->solid.row_words : NULL;
    float *values = m->values + row * length;
    for (int64_t i = 0; i < length; i++) {
      bool is_inside = bits && (bits[i / 64] >> (i % 64) & 1);
      t.exact += values[i] < m->most2;
      t.inside += is_inside;
      values[i] = value_of(m, values[i], is_inside);
      t.least = values[i] < t.least ? values[i] : t.least;
      t.greatest = values[i] > t.greatest ? values[i] : t.greatest;
    }
  }
  m->tallies[worker] = t;
}

static vxm_status measure_slices(measure *m, int64_t begin, int64_t end, vxm_error *error) {
  vxm_context *context = m->model->context;
  vxm_status status = VXM_OK;
  if (m->is_signed) {
    m->solid.begin = begin;
    m->solid.end = end;
    status = vxm_model_fill(m->model, &m->solid, error);
  }
  if (status != VXM_OK)
    return status;
  m->rows = (end - begin) * m->reach.dims[1];
  size_t tasks = (size_t)((m->rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK);
  vxm_parallel(context, tasks, start_rows, m);
  status = m->nearest ? vxm_reach_gather(&m->reach, m->nearest, m->values, begin, end, error)
                      : vxm_reach_scatter(&m->reach, m->values, begin, end, error);
  if (status == VXM_OK)
    vxm_parallel(context, tasks, finish_rows, m);
  return status;
}

/* ---- Who looks for whom ---- */

/** Whether voxels should look for triangles: a search costs as much as some tens of distances. */
static bool should_gather(const vxm_reach *reach, const vxm_space *space) {
  const double search = 30;
  double voxels = (double)space->dims[0] * (double)space->dims[1] * (double)space->dims[2];
  return isinf(reach->band) || vxm_reach_volume(reach) > search * voxels;
}

static vxm_status make_nearest(vxm_nearest **out, const vxm_reach *reach, vxm_error *error) {
  size_t count = reach->surface->triangle_count;
  vxm_error local = VXM_ERROR_INIT;
  double(*corners)[3][3] = vxm_alloc(reach->context, count, sizeof *corners, &local);
  if (!corners) {
    if (error)
      *error = local;
    return local.code;
  }
  for (size_t i = 0; i < count; i++)
    vxm_reach_corners(corners[i], reach, i);
  return vxm_nearest_create(out, reach->context, corners, count, error);
}

/** A band as wide as the grid is none: all is exact. */
static double band_of(const vxm_distance_options *options, const vxm_space *space) {
  double longest = 0;
  for (int a = 0; a < 3; a++)
    longest = fmax(longest, (double)space->dims[a]);
  return options->band == 0 || options->band > longest ? INFINITY : options->band;
}

float vxm_distance_limit(const vxm_distance_options *options, const vxm_space *space) {
  double side = 0;
  for (int a = 0; a < 3; a++)
    side = fmax(side, space->voxel_size[a]);
  return (float)(band_of(options, space) * side);
}

/* ---- Windows ---- */

static vxm_status measure_windows(measure *m, const vxm_field_target *target, const vxm_field_plan *plan,
                                  vxm_error *error) {
  int64_t length = m->reach.dims[2];
  size_t slice = (size_t)(m->reach.dims[0] * m->reach.dims[1]);
  float *block = m->values;
  vxm_status status = VXM_OK;
  for (int64_t begin = 0, end; begin < length && status == VXM_OK; begin = end) {
    end = vxm_min(begin + plan->slices, length);
    m->values = target->whole ? (float *)target->whole + (size_t)begin * slice : block;
    status = measure_slices(m, begin, end, error);
    if (status == VXM_OK && !target->whole)
      status = target->put(target->payload, m->values, begin, end, error);
  }
  return status;
}

static void sum_up(vxm_distance_report *report, const measure *m, int workers) {
  int64_t inside = 0;
  *report = (vxm_distance_report){.least = INFINITY, .greatest = -INFINITY};
  for (int w = 0; w < workers; w++) {
    report->exact += m->tallies[w].exact;
    report->least = fmin(report->least, (double)m->tallies[w].least);
    report->greatest = fmax(report->greatest, (double)m->tallies[w].greatest);
    inside += m->tallies[w].inside;
  }
  if (m->is_signed)
    vxm_model_end(m->model, &report->voxelize, inside, 0);
}

/** With all but the surface at hand. */
static vxm_status run_planned(measure *m, const vxm_field_target *target, vxm_distance_report *report,
                              const vxm_space *space, const vxm_field_plan *plan, vxm_error *error) {
  vxm_context *context = m->model->context;
  int workers = vxm_context_threads(context);
  size_t values = target->whole ? 0 : (size_t)(m->reach.dims[0] * m->reach.dims[1]);
  vxm_error local = VXM_ERROR_INIT;
  m->solid = plan->bits;
  float *block = m->values = vxm_alloc(context, (size_t)plan->slices * values, sizeof *block, &local);
  m->tallies = vxm_calloc(context, (size_t)workers, sizeof *m->tallies, &local);
  if (m->is_signed)
    m->solid.words =
        vxm_alloc(context, (size_t)plan->slices * m->solid.slice_words, sizeof *m->solid.words, &local);
  vxm_status status = local.code;
  for (int w = 0; w < workers && status == VXM_OK; w++)
    m->tallies[w] = (tally){.least = INFINITY, .greatest = -INFINITY};
  if (status == VXM_OK && m->is_signed)
    status = vxm_model_begin(m->model, space, NULL, NULL, &local);
  if (status == VXM_OK)
    status = measure_windows(m, target, plan, &local);
  if (status == VXM_OK)
    sum_up(report, m, workers);
  vxm_free(context, m->solid.words);
  vxm_free(context, m->tallies);
  vxm_free(context, block);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

vxm_status vxm_distance_run(const vxm_field_target *target, vxm_distance_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_distance_options *options, vxm_error *error) {
  vxm_surface *surface;
  vxm_lattice lattice = vxm_lattice_of(space);
  vxm_status status = vxm_surface_create(&surface, model->shape.soup, &lattice, NULL, error);
  if (status != VXM_OK)
    return status;
  measure m = {.model = model,
               .reach = vxm_reach_of(surface, space, target->layout, band_of(options, space)),
               .is_signed = !options->is_unsigned};
  m.most2 = (float)(m.reach.band * m.reach.band);
  m.most = vxm_distance_limit(options, space);
  bool gathers = should_gather(&m.reach, space);
  uint64_t fixed = gathers ? vxm_nearest_bytes(surface->triangle_count)
                           : vxm_reach_scatter_bytes(surface->triangle_count, m.reach.dims);
  uint64_t value_bytes = target->whole ? 0 : (uint64_t)(m.reach.dims[0] * m.reach.dims[1]) * sizeof *m.values;
  vxm_field_plan plan;
  status =
      vxm_field_plan_of(&plan, model, space, target->layout, m.is_signed ? 1 : 0, fixed, value_bytes, error);
  if (status == VXM_OK && gathers)
    status = make_nearest(&m.nearest, &m.reach, error);
  if (status == VXM_OK)
    status = run_planned(&m, target, report, space, &plan, error);
  vxm_nearest_destroy(m.nearest);
  vxm_surface_destroy(surface);
  return status;
}
