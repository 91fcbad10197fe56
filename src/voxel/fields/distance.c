/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/distance.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "voxel/fields/distance_band.h"
#include "voxel/model/model_report.h"

#include <math.h>
#include <string.h>

/** Slices that tiles begin at multiples of. */
enum { TILE_STEP = VXM_VALUE_TILE / 4 };

typedef vxm_band_tally tally;

typedef struct measure {
  vxm_context *context;
  vxm_distance_way way;
  vxm_model_pass *pass; /**< NULL without a sign */
  const vxm_space *space;
  vxm_distance_search search;
  int64_t dims[3];            /**< in the order of the values */
  float beyond[VXM_BVH_TILE]; /**< values beyond the band */
  bool is_signed;
  vxm_distance_band *near; /**< where there is a narrow band */
  vxm_distance_bvh_tile_fn *find;
  vxm_search **searches; /**< of each worker */
  double *squares;       /**< VXM_BVH_TILE_POINTS for each worker */
  vxm_window solid;      /**< its words NULL without a sign */
  float *values;         /**< of the slices at hand */
  int64_t begin, end;    /**< these slices */
  int64_t across, down;  /**< tiles in a row, and rows of them in a slice */
  tally *tallies;
  vxm_task_progress progress;
} measure;

vxm_distance_way vxm_distance_way_of(bool is_whole, bool takes_tiles, const vxm_distance_options *options) {
  if (is_whole)
    return VXM_DISTANCE_WHOLE;
  return takes_tiles && vxm_distance_is_narrow(options) ? VXM_DISTANCE_TILES : VXM_DISTANCE_SLICES;
}

static measure measure_of(vxm_context *context, const vxm_space *space, vxm_layout layout,
                          const vxm_distance_options *options) {
  measure m = {.context = context,
               .space = space,
               .dims = {space->dims[layout.fast], space->dims[layout.middle], space->dims[layout.slow]},
               .is_signed = !options->is_unsigned,
               .find = vxm_distance_bvh_tile_best()};
  for (int i = 0; i < VXM_BVH_TILE; i++)
    m.beyond[i] = vxm_distance_limit(options, space);
  m.across = (m.dims[0] + VXM_BVH_TILE - 1) / VXM_BVH_TILE;
  m.down = (m.dims[1] + VXM_BVH_TILE - 1) / VXM_BVH_TILE;
  return m;
}

/* ---- Values ---- */

/** Some beyond the band. */
static void fill_row(const measure *m, float *values, uint64_t inside, int count, tally *t) {
  const float most = m->beyond[0];
  memcpy(values, m->beyond, (size_t)count * sizeof *values);
  for (uint64_t bits = inside; bits; bits &= bits - 1)
    values[__builtin_ctzll(bits)] = -most;
  if (inside)
    vxm_band_tally_add(t, -most);
  if (inside != vxm_low_bits((unsigned)count))
    vxm_band_tally_add(t, most);
}

static vxm_point_block tile_of(const measure *m, size_t task) {
  vxm_point_block tile = {.max_distance = m->search.band};
  int64_t row = (int64_t)task / m->across;
  const int64_t first[3] = {(int64_t)task % m->across * VXM_BVH_TILE, row % m->down * VXM_BVH_TILE,
                            m->begin + row / m->down * VXM_BVH_TILE};
  const int64_t end[3] = {m->dims[0], m->dims[1], m->end};
  for (int a = 0; a < 3; a++) {
    tile.first[m->search.axes[a]] = first[a];
    tile.count[m->search.axes[a]] = (int)vxm_min(end[a] - first[a], VXM_BVH_TILE);
    tile.step[a] = m->space->voxel_size[a] / m->search.side;
  }
  return tile;
}

/** Tiles always lie along x, y and z, whatever the order of the values, which then makes no difference. */
static void finish_tile(const measure *m, const vxm_point_block *tile, const double *squares, tally *t) {
  static const ptrdiff_t strides[3] = {1, VXM_BVH_TILE, (ptrdiff_t)VXM_BVH_TILE * VXM_BVH_TILE};
  const int fast = m->search.axes[0], middle = m->search.axes[1], slow = m->search.axes[2],
            count = tile->count[fast];
  const int64_t at = tile->first[fast];
  for (int64_t k = tile->first[slow]; k < tile->first[slow] + tile->count[slow]; k++)
    for (int64_t j = tile->first[middle]; j < tile->first[middle] + tile->count[middle]; j++) {
      float *values = m->values + ((k - m->begin) * m->dims[1] + j) * m->dims[0] + at;
      uint64_t inside = m->solid.words ? vxm_window_row(&m->solid, j, k)[at / 64] >> (at % 64) : 0;
      inside &= vxm_low_bits((unsigned)count);
      t->inside += vxm_popcount(inside);
      ptrdiff_t row = (k - tile->first[slow]) * strides[slow] + (j - tile->first[middle]) * strides[middle];
      if (squares)
        vxm_distance_finish(&m->search, values, squares + row, strides[fast], inside, count, t);
      else
        fill_row(m, values, inside, count, t);
    }
}

static void measure_tile(size_t task, int worker, void *payload) {
  measure *m = payload;
  if (vxm_task_progress_stopped(&m->progress, worker))
    return;
  vxm_point_block tile = tile_of(m, task);
  double *squares = m->squares + (size_t)worker * VXM_BVH_TILE_POINTS;
  bool is_met = m->find(m->searches[worker], squares, &tile);
  finish_tile(m, &tile, is_met ? squares : NULL, &m->tallies[worker]);
  vxm_task_progress_step(&m->progress);
}

static vxm_status measure_slices(measure *m, const vxm_field_target *target, int64_t begin, int64_t end,
                                 vxm_error *error) {
  vxm_status status = VXM_OK;
  m->begin = begin;
  m->end = end;
  if (m->is_signed) {
    m->solid.begin = begin;
    m->solid.end = end;
    status = vxm_model_pass_fill(m->pass, &m->solid, error);
  }
  if (status != VXM_OK)
    return status;
  if (m->near)
    return m->way == VXM_DISTANCE_TILES
               ? vxm_distance_band_measure(m->near, target, NULL, &m->solid, begin, end, m->search.side,
                                           m->tallies, error)
               : vxm_distance_band_measure(m->near, NULL, m->values, &m->solid, begin, end, m->search.side,
                                           m->tallies, error);
  size_t tiles = (size_t)(m->across * m->down * ((end - begin + VXM_BVH_TILE - 1) / VXM_BVH_TILE));
  vxm_task_progress_start(&m->progress, m->context, "measuring distances", tiles, error);
  vxm_parallel(m->context, tiles, measure_tile, m);
  return vxm_task_progress_end(&m->progress);
}

/* ---- Windows ---- */

static vxm_status measure_windows(measure *m, const vxm_field_target *target, const vxm_field_plan *plan,
                                  vxm_error *error) {
  int64_t length = m->dims[2], slices = plan->slices;
  const int64_t tile = m->near ? VXM_BAND_TILE : VXM_BVH_TILE;
  if (slices > tile) /* whole tiles cost less */
    slices -= slices % tile;
  else if (m->way == VXM_DISTANCE_TILES && slices < length)
    slices -= slices % TILE_STEP;
  size_t slice = (size_t)(m->dims[0] * m->dims[1]);
  float *block = m->values;
  vxm_status status = VXM_OK;
  for (int64_t begin = 0, end; begin < length && status == VXM_OK; begin = end) {
    end = vxm_min(begin + slices, length);
    m->values = target->whole ? (float *)target->whole + (size_t)begin * slice : block;
    status = measure_slices(m, target, begin, end, error);
    if (status == VXM_OK && m->way == VXM_DISTANCE_SLICES)
      status = target->put(target->payload, m->values, begin, end, error);
  }
  return status;
}

/**
 * Finds out how much of the surface has no inside in the grid, for a warning. Only where the whole solid is
 * at hand, whose words are overwritten, and nothing that memory is short for.
 */
static vxm_status look_for_thin(measure *m, int separating, vxm_error *error) {
  vxm_voxel_pass *solid = &m->pass->solid;
  vxm_error local = VXM_ERROR_INIT;
  bool too_many = false;
  if (separating == 0 || m->solid.begin > 0 || m->solid.end < m->solid.slow_dim)
    return VXM_OK;
  vxm_thin_add(&m->pass->thin.thin, &m->solid, 0, m->solid.end, &solid->analysis->triangles, &solid->placed,
               separating, NULL, &too_many, &local);
  if (local.code != VXM_ERROR_CANCELLED)
    return VXM_OK;
  vxm_error_pass(error, &local);
  return local.code;
}

static void sum_up(vxm_distance_report *report, const measure *m, int workers) {
  int64_t inside = 0;
  *report = (vxm_distance_report){.voxelize = report->voxelize, .min = INFINITY, .max = -INFINITY};
  for (int w = 0; w < workers; w++) {
    report->exact += m->tallies[w].exact;
    report->min = fmin(report->min, (double)m->tallies[w].min);
    report->max = fmax(report->max, (double)m->tallies[w].max);
    inside += m->tallies[w].inside;
  }
  if (m->is_signed)
    vxm_model_report(m->pass, report->voxelize, inside, 0);
}

/** What the workers have of their own. */
static vxm_status make_workers(measure *m, int workers, vxm_error *error) {
  vxm_context *context = m->context;
  vxm_error local = VXM_ERROR_INIT;
  if (m->search.tree) {
    m->searches = vxm_calloc(context, (size_t)workers, sizeof *m->searches, &local);
    m->squares = vxm_alloc(context, (size_t)workers * VXM_BVH_TILE_POINTS, sizeof *m->squares, &local);
  }
  m->tallies = vxm_calloc(context, (size_t)workers, sizeof *m->tallies, &local);
  for (int w = 0; w < workers && local.code == VXM_OK; w++) {
    m->tallies[w] = (tally){.min = INFINITY, .max = -INFINITY};
    if (m->search.tree)
      vxm_search_create(&m->searches[w], m->search.tree, &local);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static void free_workers(measure *m, int workers) {
  vxm_context *context = m->context;
  for (int w = 0; w < workers && m->searches; w++)
    vxm_search_destroy(m->searches[w]);
  vxm_free(context, m->searches);
  vxm_free(context, m->squares);
  vxm_free(context, m->tallies);
}

/** With all but the surface at hand. */
static vxm_status run_planned(measure *m, const vxm_field_target *target, vxm_distance_report *report,
                              vxm_model *model, const vxm_field_plan *plan, vxm_error *error) {
  vxm_context *context = m->context;
  int workers = vxm_context_threads(context);
  size_t values = m->way == VXM_DISTANCE_SLICES ? (size_t)(m->dims[0] * m->dims[1]) : 0;
  vxm_error local = VXM_ERROR_INIT;
  m->solid = plan->bits;
  float *block = m->values = vxm_alloc(context, (size_t)plan->slices * values, sizeof *block, &local);
  if (m->is_signed)
    m->solid.words =
        vxm_alloc(context, (size_t)plan->slices * m->solid.slice_words, sizeof *m->solid.words, &local);
  vxm_status status = local.code == VXM_OK ? make_workers(m, workers, &local) : local.code;
  if (status == VXM_OK && m->is_signed)
    status = vxm_model_begin(&m->pass, model, m->space, NULL, NULL, &local);
  int separating = m->pass ? m->pass->separating : 0;
  if (status == VXM_OK && m->pass)
    vxm_model_pass_make_field(m->pass);
  if (status == VXM_OK)
    status = measure_windows(m, target, plan, &local);
  if (status == VXM_OK && m->pass)
    status = look_for_thin(m, separating, &local);
  if (status == VXM_OK)
    sum_up(report, m, workers);
  vxm_model_close(model, m->pass);
  free_workers(m, workers);
  vxm_free(context, m->solid.words);
  vxm_free(context, block);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_distance_plan(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, vxm_distance_way way, const vxm_distance_options *options,
                             vxm_error *error) {
  size_t triangles;
  int workers = vxm_context_threads(model->context);
  uint64_t fixed = vxm_distance_search_bytes(model->analysis.soup, options, &triangles);
  const int64_t dims[3] = {space->dims[layout.fast], space->dims[layout.middle], space->dims[layout.slow]};
  uint64_t each =
      vxm_distance_bvh_search_bytes(triangles) + VXM_BVH_TILE_POINTS * sizeof(double) + sizeof(void *);
  fixed += vxm_distance_is_narrow(options) ? vxm_distance_band_bytes(triangles, workers, dims)
                                           : (uint64_t)workers * each;
  fixed += (uint64_t)workers * sizeof(tally);
  uint64_t values = (uint64_t)(space->dims[layout.fast] * space->dims[layout.middle]) * sizeof(float);
  return vxm_field_plan_of(out, model, space, layout, options->is_unsigned ? 0 : 1, true, fixed,
                           way == VXM_DISTANCE_SLICES ? values : 0, way == VXM_DISTANCE_TILES ? TILE_STEP : 1,
                           error);
}

vxm_status vxm_distance_run(const vxm_field_target *target, vxm_distance_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_distance_options *options, vxm_error *error) {
  vxm_field_plan plan;
  vxm_context *context = model->context;
  vxm_distance_way way = vxm_distance_way_of(target->whole != NULL, target->put_tile != NULL, options);
  vxm_status status = vxm_distance_plan(&plan, model, space, target->layout, way, options, error);
  if (status != VXM_OK)
    return status;
  measure m = measure_of(context, space, target->layout, options);
  m.way = way;
  status = vxm_distance_search_create(&m.search, context, model->analysis.soup, space, target->layout,
                                      options, error);
  if (status == VXM_OK && m.search.clusters)
    status = vxm_distance_band_create(&m.near, m.search.clusters, vxm_context_threads(context), error);
  if (status == VXM_OK)
    status = run_planned(&m, target, report, model, &plan, error);
  vxm_distance_band_destroy(m.near);
  vxm_distance_search_destroy(&m.search);
  return status;
}
