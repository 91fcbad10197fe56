/* SPDX-License-Identifier: BSD-3-Clause */
/** Measuring one phase: a run to warm up, then runs until both their number and their time are enough. */
#include "cli/bench.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Results ---- */

const bench_result *bench_find(const bench_results *results, const char *phase, int64_t resolution,
                               int threads, int engine) {
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (!*item->left_out && item->resolution == resolution && item->threads == threads &&
        item->engine == engine && strcmp(item->phase->name, phase) == 0)
      return item;
  }
  return NULL;
}

/** Adds an empty result; NULL without memory. */
static bench_result *add_result(bench_results *results) {
  if (results->count == results->capacity) {
    int capacity = results->capacity ? 2 * results->capacity : 64;
    bench_result *items = realloc(results->items, (size_t)capacity * sizeof *items);
    if (!items)
      return NULL;
    results->items = items;
    results->capacity = capacity;
  }
  bench_result *item = &results->items[results->count++];
  *item = (bench_result){0};
  return item;
}

void bench_results_drop(bench_results *results) {
  for (int i = 0; i < results->count; i++)
    json_decref(results->items[i].figures);
  free(results->items);
}

/* ---- Runs ---- */

/** @param output NULL = not wanted */
static vxm_status run_once(bench_stage *stage, const bench_phase *phase, double *ms, bench_output *output) {
  double start = cli_clock();
  vxm_status status = phase->run(stage);
  *ms = cli_clock() - start;
  if (output && status == VXM_OK && phase->tell)
    phase->tell(output, stage);
  bench_stage_drop(stage);
  stage->run++;
  if (status == VXM_OK && cli_signal())
    status = stage->cli->error.code = VXM_ERROR_CANCELLED;
  return status;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static vxm_status repeat(bench_result *out, bench_stage *stage, const bench_phase *phase, double time_ms) {
  static double times[BENCH_RUNS_MOST];
  double total = 0;
  int count = 0;
  while (count < BENCH_RUNS_LEAST || (total < time_ms && count < BENCH_RUNS_MOST)) {
    vxm_status status = run_once(stage, phase, &times[count], NULL);
    if (status != VXM_OK)
      return status;
    total += times[count];
    times[count++] /= stage->variants > 0 ? (double)stage->variants : 1;
  }
  qsort(times, (size_t)count, sizeof times[0], compare);
  out->runs = count;
  out->least_ms = times[0];
  out->median_ms = (times[count / 2] + times[(count - 1) / 2]) / 2;
  return VXM_OK;
}

static vxm_status measure(bench_result *out, bench_stage *stage, const bench_phase *phase, double time_ms) {
  stage->run = 0;
  double first;
  bench_output output = {0};
  vxm_status status = phase->begin ? phase->begin(stage) : VXM_OK;
  if (status == VXM_OK)
    status = run_once(stage, phase, &first, &output);
  out->bytes = output.bytes;
  out->voxels = output.voxels;
  out->figures = output.figures;
  if (status == VXM_OK)
    status = repeat(out, stage, phase, time_ms);
  if (status == VXM_OK && !out->figures)
    out->figures = bench_stages(stage, phase);
  bench_stage_drop(stage);
  bench_stage_end_phase(stage);
  return status;
}

/* ---- What is left out ---- */

/** Where no smaller resolution has been measured, this one tells how slow a phase is. */
enum { PROBE = 32, PROBE_OPENCL = 8 };

static vxm_status probe(double *ms, bench_stage *stage, const bench_phase *phase, int64_t at,
                        int64_t resolution) {
  vxm_status status = bench_stage_resize(stage, at);
  if (status == VXM_OK && phase->begin)
    status = phase->begin(stage);
  for (int i = 0; i < 2 && status == VXM_OK; i++) /* the first one warms up */
    status = run_once(stage, phase, ms, NULL);
  bench_stage_drop(stage);
  bench_stage_end_phase(stage);
  return status == VXM_OK ? bench_stage_resize(stage, resolution) : status;
}

/** Judges by the nearest smaller resolution how long a run will take, which grows as the voxels do. */
static vxm_status leave_out_if_slow(bench_result *out, const bench_results *results, bench_stage *stage) {
  const bench_phase *phase = out->phase;
  int64_t from = 0, at = phase->kind == BENCH_OPENCL ? PROBE_OPENCL : PROBE;
  double ms = 0;
  for (int i = 0; i < results->count; i++) {
    const bench_result *item = &results->items[i];
    if (item->phase != phase || item->threads != out->threads || item->engine != out->engine ||
        *item->left_out || item->runs == 0 || item->resolution <= from || item->resolution >= out->resolution)
      continue;
    from = item->resolution;
    ms = item->median_ms;
  }
  if (from == 0 && out->resolution > 2 * at) {
    vxm_status status = probe(&ms, stage, phase, at, out->resolution);
    if (status != VXM_OK)
      return status;
    from = at;
  }
  if (from == 0)
    return VXM_OK;
  double expected = ms * pow((double)out->resolution / (double)from, 3);
  if (expected > phase->most_ms)
    snprintf(out->left_out, sizeof out->left_out,
             "a run would take about %.3g s, judging by %.3g s at %" PRId64 "; --phases %s measures it",
             expected / 1e3, ms / 1e3, from, phase->name);
  return VXM_OK;
}

/** Too little memory for one phase or resolution does not end the others, nor does an engine that is not of
 * OpenCL, or a buffer too small for a byte per voxel. */
static vxm_status leave_out_if_impossible(bench_result *out, bench_stage *stage, vxm_status status) {
  bool no_memory = status == VXM_ERROR_MEMORY || status == VXM_ERROR_MEMORY_LIMIT;
  bool not_here = status == VXM_ERROR_UNAVAILABLE || status == VXM_ERROR_RANGE;
  if (!no_memory && (!not_here || (out->phase->kind != BENCH_OPENCL && out->phase->kind != BENCH_BASELINE)))
    return status;
  snprintf(out->left_out, sizeof out->left_out, "%s", stage->cli->error.text);
  stage->cli->error = (vxm_error)VXM_ERROR_INIT;
  return VXM_OK;
}

vxm_status bench_measure(bench_results *results, bench_stage *stage, const bench_plan *plan,
                         const bench_phase *phase, int64_t resolution) {
  bench_result made = {
      .phase = phase, .resolution = resolution, .threads = stage->threads, .engine = stage->engine};
  vxm_status status = VXM_OK;
  if (phase->most_ms > 0 && !plan->forced)
    status = leave_out_if_slow(&made, results, stage);
  if (status == VXM_OK && !*made.left_out)
    status = measure(&made, stage, phase, plan->time_ms);
  status = leave_out_if_impossible(&made, stage, status);
  if (status != VXM_OK) {
    json_decref(made.figures);
    return status;
  }
  const bench_result *base = bench_find(results, "memset", resolution, stage->threads, 0);
  if (base && phase->per_grid && phase->kind != BENCH_OPENCL && phase != base->phase && base->median_ms > 0)
    made.of_memset = made.median_ms / base->median_ms;
  bench_result *place = add_result(results);
  if (!place) {
    stage->cli->error.code = VXM_ERROR_MEMORY;
    snprintf(stage->cli->error.text, sizeof stage->cli->error.text, "out of memory");
    json_decref(made.figures);
    return VXM_ERROR_MEMORY;
  }
  *place = made;
  return VXM_OK;
}
