/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/coverage_spans.h"
#include "base/threads.h"
#include "mesh/sort.h"

#include <string.h>

/** What a thread works with. */
typedef struct scratch {
  uint64_t *keys; /**< of a part: places of crossings; twice as many, for sorting */
  size_t key_capacity;
  uint64_t *spans; /**< of all parts: beginning << SPAN_BITS | length - 1; twice as many */
  size_t span_count, span_capacity;
  int16_t *changes;  /**< of each row of voxels, from each voxel to the next: of the sub-voxels set in it */
  uint64_t *touched; /**< of each row: voxels with a change */
  vxm_status status;
  vxm_error error;
} scratch;

/** A row has at most 2^20 sub-voxels. */
enum { SPAN_BITS = 20 };

typedef struct span_job {
  const vxm_coverage_values *values;
  vxm_model_pass *pass;
  vxm_window fine;
  size_t row_bits; /**< of sub-voxels in a slab */
  bool one_part;
  int shift;                          /**< a voxel has 2^shift sub-voxels along an axis */
  int64_t row_length, rows;           /**< of voxels */
  size_t change_count, touched_words; /**< of a row */
  vxm_crossing_bins *bins;
  scratch *scratch;
  vxm_coverage_tally *tallies;
  vxm_task_progress watch;
} span_job;

bool vxm_coverage_has_spans(const vxm_model_pass *pass) {
  const vxm_voxelize_options *options = &pass->solid.options;
  return options->mode == VXM_MODE_SOLID && options->method == VXM_METHOD_VOTE &&
         !vxm_voxel_pass_ops(&pass->solid) && !vxm_votes_wanted(pass->solid.analysis, options);
}

uint64_t vxm_coverage_spans_bytes(int64_t row_length, int64_t rows) {
  uint64_t changes = (uint64_t)row_length + 2;
  return (uint64_t)rows * (changes * sizeof(int16_t) + (changes / 64 + 1) * sizeof(uint64_t));
}

/* ---- Spans ---- */

static bool keep_keys(const span_job *job, scratch *s, size_t count) {
  if (s->status == VXM_OK)
    s->status = vxm_grow(job->pass->solid.context, (void **)&s->keys, &s->key_capacity, 2 * count,
                         sizeof *s->keys, &s->error);
  return s->status == VXM_OK;
}

/** The places of a part's crossings in a slab, of all threads. */
static size_t take_keys(const span_job *job, scratch *s, vxm_crossing_bin_reader *reader, uint32_t part) {
  size_t count = 0;
  vxm_crossing_bin_piece piece;
  for (size_t w = 0; w < job->bins->workers; w++)
    while (reader[w].part == part && vxm_crossing_bin_next(&reader[w], &piece)) {
      if (!piece.is_bitmap) {
        if (keep_keys(job, s, count + piece.count))
          memcpy(s->keys + count, piece.data, piece.count * sizeof *s->keys);
        count += s->status == VXM_OK ? piece.count : 0;
        continue;
      }
      for (size_t word = 0; word < piece.count; word++)
        for (uint64_t left = piece.data[word]; left; left &= left - 1)
          if (keep_keys(job, s, count + 1))
            s->keys[count++] = 64 * word + (uint64_t)__builtin_ctzll(left);
    }
  return count;
}

/** A row of sub-voxels and its first place, which are moved on from place to place upward. */
typedef struct row_cursor {
  uint64_t row, first;
} row_cursor;

static inline void move_to(row_cursor *at, uint64_t place, uint64_t row_bits) {
  if (place - at->first < row_bits)
    return;
  at->row = place / row_bits;
  at->first = at->row * row_bits;
}

/** The spans between a part's crossings, row by row; returns whether there is a voxel in any. */
static bool add_spans(const span_job *job, scratch *s, size_t count) {
  vxm_context *context = job->pass->solid.context;
  uint64_t length = (uint64_t)job->fine.fast_dim;
  bool any = false;
  vxm_sort_keys(s->keys, s->keys + count, count);
  if (s->status == VXM_OK)
    s->status = vxm_grow(context, (void **)&s->spans, &s->span_capacity, 2 * (s->span_count + count),
                         sizeof *s->spans, &s->error);
  row_cursor at = {0, 0};
  for (size_t i = 0; i < count && s->status == VXM_OK;) {
    uint64_t begin = s->keys[i];
    move_to(&at, begin, job->row_bits);
    uint64_t end = at.first + length;
    bool pair = i + 1 < count && s->keys[i + 1] - at.first < job->row_bits;
    if (pair)
      end = s->keys[i + 1];
    if (begin < end)
      s->spans[s->span_count++] = begin << SPAN_BITS | (end - begin - 1);
    any |= begin < end;
    i += pair ? 2 : 1;
  }
  return any;
}

/* ---- Numbers ---- */

/** From sub-voxel `at` of a row on, all are set, or no more. */
static inline void change(int16_t *changes, uint64_t *touched, uint64_t at, int shift, int sign) {
  uint64_t voxel = at >> shift;
  int n = 1 << shift, rest = (int)(at & (uint64_t)(n - 1));
  changes[voxel] = (int16_t)(changes[voxel] + sign * (n - rest));
  changes[voxel + 1] = (int16_t)(changes[voxel + 1] + sign * rest);
  touched[voxel / 64] |= UINT64_C(1) << (voxel % 64);
  touched[(voxel + 1) / 64] |= UINT64_C(1) << ((voxel + 1) % 64);
}

static void add_span(const span_job *job, scratch *s, row_cursor *at, uint64_t begin, uint64_t end) {
  move_to(at, begin, job->row_bits);
  uint64_t row = at->row, first = at->first;
  while (row >= (uint64_t)job->fine.middle_dim) /* a few slices */
    row -= (uint64_t)job->fine.middle_dim;
  size_t to = (size_t)(row >> job->shift);
  int16_t *changes = s->changes + to * job->change_count;
  uint64_t *touched = s->touched + to * job->touched_words;
  change(changes, touched, begin - first, job->shift, 1);
  change(changes, touched, end - first, job->shift, -1);
}

/** All spans; those of several parts may overlap. */
static void add_union(const span_job *job, scratch *s, bool one_part) {
  if (!one_part)
    vxm_sort_keys(s->spans, s->spans + s->span_count, s->span_count);
  uint64_t begin = 0, end = 0;
  row_cursor row = {0, 0};
  for (size_t i = 0; i < s->span_count; i++) {
    uint64_t at = s->spans[i] >> SPAN_BITS, length = (s->spans[i] & vxm_low_bits(SPAN_BITS)) + 1;
    if (at < end) {
      end = at + length > end ? at + length : end;
      continue;
    }
    if (begin < end)
      add_span(job, s, &row, begin, end);
    begin = at;
    end = at + length;
  }
  if (begin < end)
    add_span(job, s, &row, begin, end);
}

/** The values of a row from its changes, which are cleared. */
static void store_row(const span_job *job, scratch *s, int64_t row, size_t at, vxm_coverage_tally *tally) {
  int16_t *changes = s->changes + (size_t)row * job->change_count;
  uint64_t *touched = s->touched + (size_t)row * job->touched_words;
  size_t length = (size_t)job->row_length, done = 0;
  int count = 0;
  for (size_t w = 0; w < job->touched_words; w++) {
    for (uint64_t left = touched[w]; left; left &= left - 1) {
      size_t voxel = 64 * w + (size_t)__builtin_ctzll(left);
      int by = changes[voxel];
      changes[voxel] = 0;
      if (voxel >= length || by == 0)
        continue;
      if (voxel > done)
        vxm_coverage_store_run(job->values, at + done, voxel - done, (unsigned)count, tally);
      count += by;
      done = voxel;
    }
    touched[w] = 0;
  }
  if (done < length)
    vxm_coverage_store_run(job->values, at + done, length - done, (unsigned)count, tally);
}

/** A slice of voxels. */
static void do_slice(size_t task, int worker, void *payload) {
  span_job *job = payload;
  scratch *s = &job->scratch[worker];
  enum { WORKERS_MAX = 256 };
  vxm_crossing_bin_reader reader[WORKERS_MAX];
  if (s->status != VXM_OK || vxm_task_progress_stopped(&job->watch, worker))
    return;
  size_t parts = 0;
  s->span_count = 0;
  for (size_t w = 0; w < job->bins->workers; w++)
    reader[w] = vxm_crossing_bin_read(vxm_crossing_bins_at(job->bins, w, 0, task), job->one_part);
  for (;;) {
    uint32_t part = VXM_BIN_NONE;
    for (size_t w = 0; w < job->bins->workers; w++)
      part = reader[w].part < part ? reader[w].part : part;
    if (part == VXM_BIN_NONE || s->status != VXM_OK)
      break;
    if (add_spans(job, s, take_keys(job, s, reader, part)) && job->pass->solid.has_voxels)
      atomic_store_explicit(&job->pass->solid.has_voxels[part], 1, memory_order_relaxed);
    parts++;
  }
  if (s->status != VXM_OK)
    return;
  add_union(job, s, parts <= 1);
  for (int64_t row = 0; row < job->rows; row++)
    store_row(job, s, row, (size_t)(((int64_t)task * job->rows + row) * job->row_length),
              &job->tallies[worker]);
  vxm_task_progress_step(&job->watch);
}

/* ---- All of it ---- */

static vxm_status make_scratch(span_job *job, int workers, vxm_error *error) {
  vxm_context *context = job->pass->solid.context;
  vxm_error local = VXM_ERROR_INIT;
  job->scratch = vxm_calloc(context, (size_t)workers, sizeof *job->scratch, &local);
  for (int w = 0; w < workers && local.code == VXM_OK; w++) {
    scratch *s = &job->scratch[w];
    s->error = (vxm_error)VXM_ERROR_INIT;
    s->changes = vxm_calloc(context, (size_t)job->rows * job->change_count, sizeof *s->changes, &local);
    s->touched = vxm_calloc(context, (size_t)job->rows * job->touched_words, sizeof *s->touched, &local);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static void free_scratch(span_job *job, int workers) {
  vxm_context *context = job->pass->solid.context;
  for (int w = 0; w < workers && job->scratch; w++) {
    vxm_free(context, job->scratch[w].touched);
    vxm_free(context, job->scratch[w].changes);
    vxm_free(context, job->scratch[w].spans);
    vxm_free(context, job->scratch[w].keys);
  }
  vxm_free(context, job->scratch);
}

static vxm_status run(span_job *job, const vxm_raster_schedule *crossings, int workers, vxm_error *error) {
  vxm_context *context = job->pass->solid.context;
  size_t slices = (size_t)(job->fine.end - job->fine.begin) / (size_t)job->values->n;
  vxm_task_progress_start(&job->watch, context, "measuring coverage", crossings->range_count + slices, error);
  vxm_raster_schedule_run(crossings, 0, job->bins, &job->watch);
  vxm_status status = vxm_crossing_bins_check(job->bins, error);
  if (status == VXM_OK)
    status = make_scratch(job, workers, error);
  if (status == VXM_OK && job->watch.status == VXM_OK)
    vxm_parallel(context, slices, do_slice, job);
  for (int w = 0; w < workers && status == VXM_OK; w++)
    if (job->scratch[w].status != VXM_OK) {
      status = job->scratch[w].status;
      vxm_error_pass(error, &job->scratch[w].error);
    }
  free_scratch(job, workers);
  return status == VXM_OK ? vxm_task_progress_end(&job->watch) : status;
}

vxm_status vxm_coverage_spans(const vxm_coverage_values *values, vxm_model_pass *pass, const vxm_window *fine,
                              vxm_coverage_tally *tallies, bool *done, vxm_error *error) {
  const vxm_triangle_set *triangles = &pass->solid.analysis->triangles;
  vxm_workspace *workspace = pass->solid.workspace;
  int workers = vxm_context_threads(pass->solid.context), n = values->n;
  span_job job = {
      .values = values, .pass = pass, .fine = *fine, .bins = &workspace->bins, .tallies = tallies};
  job.one_part = triangles->split.part_count == 1;
  job.row_bits = 64 * fine->row_words;
  job.shift = n == 2 ? 1 : n == 4 ? 2 : 3;
  job.row_length = fine->fast_dim / n;
  job.rows = fine->middle_dim / n;
  job.change_count = (size_t)job.row_length + 2;
  job.touched_words = job.change_count / 64 + 1;
  vxm_columns columns = vxm_columns_of(fine, fine->layout.fast);
  columns.slab_shift = job.shift;
  columns.roles = VXM_ROLE_FACE | VXM_ROLE_CAP;
  columns.triangle_end = vxm_roles_end(triangles, triangles->split.part_count - 1, columns.roles);
  vxm_status status =
      vxm_raster_schedule_plan(&workspace->crossings, triangles, &pass->solid.placed, &columns, 1, error);
  *done = workspace->crossings.round_count <= 1;
  if (status != VXM_OK || !*done)
    return status;
  size_t slices = (size_t)(fine->end - fine->begin) / (size_t)n;
  status = vxm_crossing_bins_reset(&workspace->bins, (size_t)workers, 1, slices,
                                   (size_t)n * fine->row_words * (size_t)fine->middle_dim, error);
  return status == VXM_OK ? run(&job, &workspace->crossings, workers, error) : status;
}
