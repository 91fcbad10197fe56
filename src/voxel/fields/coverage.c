/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/coverage.h"
#include "base/threads.h"
#include "voxel/engine/engine.h"
#include "voxel/fields/coverage_parity.h"
#include "voxel/model/model_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { ROWS_PER_TASK = 8 };

typedef struct reduction {
  int n;
  vxm_coverage_values values;
  const vxm_window *fine;
  int64_t row_length, rows; /**< of a slice of the coverage */
  int64_t slices;           /**< at hand */
  uint16_t *counts;         /**< of the groups at hand, where an engine counts them; else NULL */
  uint64_t *sums; /**< for each worker two words for each of a row: groups 0, 2, 4, ... and 1, 3, 5, ... */
  vxm_coverage_tally *tallies;
  vxm_coverage_scratch *scratch; /**< of windows by parity */
} reduction;

/* ---- Counting bits in groups ---- */

/** Bits set in each group of n bits, in place; n is a constant where this is inlined. */
static inline uint64_t count_groups(uint64_t word, int n) {
  word -= word >> 1 & UINT64_C(0x5555555555555555);
  if (n >= 4)
    word = (word & UINT64_C(0x3333333333333333)) + (word >> 2 & UINT64_C(0x3333333333333333));
  if (n == 8)
    word = (word + (word >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
  return word;
}

/** The lower n of every 2 n bits. */
static inline uint64_t even_groups(int n) {
  return n == 2   ? UINT64_C(0x3333333333333333)
         : n == 4 ? UINT64_C(0x0f0f0f0f0f0f0f0f)
                  : UINT64_C(0x00ff00ff00ff00ff);
}

/** Adds a row of bits to the sums. Two groups share 2 n bits, which hold n^3 = 8, 64 and 512. */
static inline void add_row(uint64_t *sums, const uint64_t *row, size_t words, int n) {
  for (size_t w = 0; w < words; w++) {
    uint64_t groups = count_groups(row[w], n), mask = even_groups(n);
    sums[2 * w] += groups & mask;
    sums[2 * w + 1] += groups >> n & mask;
  }
}

/** The sums of the n^2 rows of bits that make a row of the coverage. */
static inline void sum_rows(const reduction *r, uint64_t *sums, int64_t middle, int64_t slow, int n) {
  size_t words = r->fine->row_words;
  memset(sums, 0, 2 * words * sizeof *sums);
  for (int64_t s = slow * n; s < (slow + 1) * n; s++)
    for (int64_t m = middle * n; m < (middle + 1) * n; m++)
      add_row(sums, vxm_window_row(r->fine, m, r->fine->begin + s), words, n);
}

/* ---- Values ---- */

/** Values of the groups of one word, `some` of them. */
static void store_word(const reduction *r, const uint64_t pair[2], size_t at, size_t some,
                       vxm_coverage_tally *t) {
  unsigned n = (unsigned)r->n;
  uint64_t field = vxm_low_bits(2 * n);
  if ((pair[0] | pair[1]) == 0) {
    vxm_coverage_store_run(&r->values, at, some, 0, t);
    return;
  }
  for (size_t g = 0; g < some; g++) {
    unsigned count = (unsigned)(pair[g % 2] >> (g / 2 * 2 * n) & field);
    vxm_coverage_store(&r->values, at + g, count, t);
  }
}

/** Values of rows whose groups an engine has counted. */
static void store_rows(size_t task, int worker, void *payload) {
  const reduction *r = payload;
  int64_t end = vxm_min(((int64_t)task + 1) * ROWS_PER_TASK, r->rows * r->slices);
  for (size_t at = task * ROWS_PER_TASK * (size_t)r->row_length; at < (size_t)(end * r->row_length); at++)
    vxm_coverage_store(&r->values, at, r->counts[at], &r->tallies[worker]);
}

static void reduce_rows(size_t task, int worker, void *payload) {
  const reduction *r = payload;
  size_t words = r->fine->row_words, groups = 64 / (size_t)r->n;
  uint64_t *sums = r->sums + (size_t)worker * 2 * words;
  int64_t end = vxm_min(((int64_t)task + 1) * ROWS_PER_TASK, r->rows * r->slices);
  for (int64_t row = (int64_t)task * ROWS_PER_TASK; row < end; row++) {
    int64_t middle = row % r->rows, slow = row / r->rows;
    if (r->n == 2)
      sum_rows(r, sums, middle, slow, 2);
    else if (r->n == 4)
      sum_rows(r, sums, middle, slow, 4);
    else
      sum_rows(r, sums, middle, slow, 8);
    size_t at = (size_t)(row * r->row_length), left = (size_t)r->row_length;
    for (size_t w = 0; w < words; w++, at += groups, left -= groups) {
      store_word(r, sums + 2 * w, at, left < groups ? left : groups, &r->tallies[worker]);
      if (left <= groups)
        break;
    }
  }
}

/* ---- Windows ---- */

static vxm_status finer_space(vxm_space *out, const vxm_space *space, int n, vxm_error *error) {
  *out = *space;
  for (int a = 0; a < 3; a++) {
    out->dims[a] *= n;
    out->voxel_size[a] /= n;
    if (out->dims[a] > VXM_DIM_MAX)
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "coverage: %" PRId64 " voxels of %d sub-voxels are more than 2^20 along an axis",
                      space->dims[a], n);
  }
  return vxm_space_check(out, error);
}

static bool has_counts(const vxm_engine *engine) {
  return engine && engine->ops && engine->ops->count;
}

/** Lets the engine count the groups of a window, if it can. */
static vxm_status count_elsewhere(reduction *r, vxm_engine *engine, const vxm_window *fine,
                                  vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  uint16_t *counts = r->counts;
  r->counts = NULL;
  if (!counts || !has_counts(engine))
    return VXM_OK;
  vxm_status status = engine->ops->count(engine, counts, fine, r->n, &local);
  if (status == VXM_OK)
    r->counts = counts;
  else if (status == VXM_ERROR_RANGE || vxm_engine_falls_back(engine, &local)) /* the bits are here already */
    return VXM_OK;
  else
    vxm_error_pass(error, &local);
  return status;
}

/** Crossings that are held at once, at most, by their bound: one in two to ten is there. */
static const double most_crossings = 1 << 26;
/** In bins that are half full; half of what is left of the memory. */
static const double bytes_of_a_crossing = 32;

/** Slices whose crossings are held at once, at least those planned. */
static int64_t slices_by_parity(const vxm_field_plan *plan, const vxm_model_pass *pass, int64_t length) {
  double bound = vxm_raster_schedule_placed_bound(&pass->solid.placed, VXM_ROLE_FACE | VXM_ROLE_CAP);
  double most = fmin(most_crossings, (double)vxm_memory_left(pass->solid.context) / bytes_of_a_crossing);
  double slices = bound <= most ? (double)length : ceil((double)length / ceil(bound / most));
  return vxm_max((int64_t)slices, plan->slices);
}

/** A window by its sub-voxels. */
static vxm_status reduce_window(reduction *r, vxm_window *fine, const vxm_field_plan *plan,
                                vxm_model_pass *pass, vxm_error *error) {
  vxm_context *context = pass->solid.context;
  vxm_status status = VXM_OK;
  if (!fine->words)
    fine->words = vxm_try_alloc(context, (size_t)(plan->slices * r->n) * fine->slice_words,
                                sizeof *fine->words, &status, error);
  if (!fine->words)
    return status;
  status = vxm_model_pass_fill(pass, fine, error);
  if (status == VXM_OK)
    status = count_elsewhere(r, pass->solid.engine, fine, error);
  if (status == VXM_OK)
    vxm_parallel(context, (size_t)((r->rows * r->slices + ROWS_PER_TASK - 1) / ROWS_PER_TASK),
                 r->counts ? store_rows : reduce_rows, r);
  return status;
}

/** From so many bytes of values on they are stored past the cache. */
static const double streaming_bytes = 1 << 25;

static vxm_status reduce_windows(reduction *r, const vxm_field_target *target, vxm_window *fine,
                                 const vxm_field_plan *plan, vxm_model_pass *pass, vxm_error *error) {
  vxm_status status = VXM_OK;
  int64_t length = fine->slow_dim / r->n, slices = plan->slices;
  size_t slice_bytes = (size_t)(r->row_length * r->rows) * vxm_scalar_bytes(r->values.scalar);
  unsigned char *block = r->values.out;
  bool by_parity = vxm_coverage_by_parity(pass);
  r->values.streaming = target->whole && (double)slice_bytes * (double)length >= streaming_bytes;
  if (by_parity && target->whole)
    slices = slices_by_parity(plan, pass, length);
  r->fine = fine;
  for (int64_t begin = 0, end; begin < length && status == VXM_OK; begin = end) {
    end = vxm_min(begin + (by_parity ? slices : plan->slices), length);
    fine->begin = begin * r->n;
    fine->end = end * r->n;
    r->slices = end - begin;
    r->values.out = target->whole ? (unsigned char *)target->whole + (size_t)begin * slice_bytes : block;
    if (by_parity) {
      status = vxm_coverage_parity(&r->values, pass, fine, r->tallies, &r->scratch, &by_parity, error);
      if (status == VXM_OK && !by_parity) { /* too many at once: fewer slices, then all by sub-voxels */
        by_parity = slices > plan->slices;
        slices = vxm_max(slices / 2, plan->slices);
        end = begin;
        continue;
      }
    } else
      status = reduce_window(r, fine, plan, pass, error);
    if (status == VXM_OK && !target->whole)
      status = target->put(target->payload, r->values.out, begin, end, error);
  }
  return status;
}

static void sum_up(vxm_coverage_report *report, const reduction *r, const vxm_space *space, int workers,
                   vxm_model_pass *pass) {
  *report = (vxm_coverage_report){.voxelize = report->voxelize};
  int64_t subvoxels = 0;
  for (int w = 0; w < workers; w++) {
    subvoxels += r->tallies[w].subvoxels;
    report->full += r->tallies[w].full;
    report->partial += r->tallies[w].partial;
  }
  const double *size = space->voxel_size;
  report->volume = (double)subvoxels / (double)(r->n * r->n * r->n) * size[0] * size[1] * size[2];
  vxm_model_report(pass, report->voxelize, subvoxels, 0);
}

vxm_status vxm_coverage_plan(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, bool is_whole, const vxm_coverage_options *options,
                             vxm_error *error) {
  vxm_space finer;
  vxm_status status = finer_space(&finer, space, options->subdivision, error);
  if (status != VXM_OK)
    return status;
  size_t workers = (size_t)vxm_context_threads(model->context);
  size_t row_words = vxm_window_of(&finer, layout, 0, 0).row_words;
  size_t values =
      (size_t)(space->dims[layout.fast] * space->dims[layout.middle]) * vxm_scalar_bytes(options->scalar);
  size_t scratch = workers * (2 * row_words * sizeof(uint64_t) + sizeof(vxm_coverage_tally) +
                              vxm_coverage_parity_bytes(model, options->subdivision, space->dims[layout.fast],
                                                        space->dims[layout.middle]));
  size_t counts = has_counts(model->options.engine)
                      ? (size_t)(space->dims[layout.fast] * space->dims[layout.middle]) * sizeof(uint16_t)
                      : 0;
  return vxm_field_plan_of(out, model, &finer, layout, options->subdivision, true, scratch,
                           (is_whole ? 0 : values) + counts, 1, error);
}

vxm_status vxm_coverage_run(const vxm_field_target *target, vxm_coverage_report *report, vxm_model *model,
                            const vxm_space *space, const vxm_coverage_options *options, vxm_error *error) {
  vxm_context *context = model->context;
  int workers = vxm_context_threads(context), n = options->subdivision;
  vxm_layout layout = target->layout;
  reduction r = {.n = n,
                 .values = vxm_coverage_values_of(n, options->scalar),
                 .row_length = space->dims[layout.fast],
                 .rows = space->dims[layout.middle]};
  vxm_space finer;
  vxm_status status = finer_space(&finer, space, n, error);
  if (status != VXM_OK)
    return status;
  vxm_field_plan plan;
  status = vxm_coverage_plan(&plan, model, space, layout, target->whole != NULL, options, error);
  if (status != VXM_OK)
    return status;
  size_t row_words = plan.bits.row_words;
  size_t value_bytes =
      target->whole ? 0 : (size_t)(r.row_length * r.rows) * vxm_scalar_bytes(options->scalar);
  vxm_error local = VXM_ERROR_INIT;
  vxm_model_pass *pass = NULL;
  vxm_window fine = plan.bits;
  r.sums = vxm_alloc(context, (size_t)workers * row_words, 2 * sizeof *r.sums, &local);
  r.tallies = vxm_calloc(context, (size_t)workers, sizeof *r.tallies, &local);
  void *block = vxm_alloc(context, (size_t)plan.slices, value_bytes, &local);
  r.values.out = block;
  size_t count_bytes =
      has_counts(model->options.engine) ? (size_t)(r.row_length * r.rows) * sizeof *r.counts : 0;
  uint16_t *counts = vxm_alloc(context, (size_t)plan.slices, count_bytes, &local);
  r.counts = count_bytes > 0 ? counts : NULL;
  status = r.sums && r.tallies && block && counts ? VXM_OK : local.code;
  if (status == VXM_OK)
    status = vxm_model_begin(&pass, model, &finer, NULL, NULL, &local);
  if (status == VXM_OK && pass)
    vxm_model_pass_make_field(pass);
  if (status == VXM_OK)
    status = reduce_windows(&r, target, &fine, &plan, pass, &local);
  if (status == VXM_OK)
    sum_up(report, &r, space, workers, pass);
  vxm_model_close(model, pass);
  vxm_coverage_scratch_destroy(r.scratch);
  vxm_free(context, counts);
  vxm_free(context, block);
  vxm_free(context, r.tallies);
  vxm_free(context, r.sums);
  vxm_free(context, fine.words);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}
