/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/coverage_parity.h"
#include "base/threads.h"
#include "voxel/fields/coverage_flips.h"
#include "voxel/model/model.h"

/** What a thread works with: the flips of the rows at hand, and those of a part beside others. None are left
 * from one slice to the next. */
typedef struct scratch {
  vxm_coverage_flips all, part;
} scratch;

struct vxm_coverage_scratch {
  vxm_context *context;
  size_t some_rows; /**< of a slice, as many as a thread does at once */
  size_t count;     /**< of threads that have theirs */
  scratch of[];
};

/** Bytes of flips that a thread takes at most, and all of them together, where a row does not take more. */
static const uint64_t most_flips = 16 << 20, most_together = 64 << 20;

typedef struct parity_job {
  const vxm_coverage_values *values;
  vxm_model_pass *pass;
  vxm_window fine;
  vxm_coverage_flips shape;
  size_t part_count;
  size_t rows; /**< of a slice */
  vxm_crossing_bins *bins;
  vxm_coverage_scratch *scratch;
  vxm_coverage_tally *tallies;
  vxm_task_progress watch;
} parity_job;

bool vxm_coverage_by_parity(const vxm_model_pass *pass) {
  const vxm_voxelize_options *options = &pass->solid.options;
  return options->mode == VXM_MODE_SOLID && options->method == VXM_METHOD_VOTE &&
         !vxm_voxel_pass_ops(&pass->solid) && !vxm_votes_wanted(pass->solid.analysis, options) &&
         !vxm_overlaps_wanted(pass->solid.analysis, options);
}

/** Rows of voxels that a thread does at once, of a slice of so many. */
static size_t rows_at_once(vxm_context *context, const vxm_coverage_flips *shape, size_t rows) {
  size_t left = vxm_memory_left(context), threads = (size_t)vxm_context_threads(context);
  uint64_t most = most_flips < most_together / threads ? most_flips : most_together / threads;
  if (left != SIZE_MAX && left / (32 * threads) < most)
    most = left / (32 * threads);
  size_t some = (size_t)(most / vxm_coverage_flips_bytes(shape, 1));
  return some < 1 ? 1 : some < rows ? some : rows;
}

uint64_t vxm_coverage_parity_bytes(const vxm_model *model, int n, int64_t row_length, int64_t rows) {
  vxm_coverage_flips shape = vxm_coverage_flips_of(n, (size_t)row_length);
  uint64_t bytes = vxm_coverage_flips_bytes(&shape, rows_at_once(model->context, &shape, (size_t)rows));
  return model->analysis.triangles.split.part_count > 1 ? 2 * bytes : bytes;
}

/* ---- Slices ---- */

enum { WORKERS_MAX = 256 };

static uint32_t next_part(const parity_job *job, const vxm_crossing_bin_reader *reader) {
  uint32_t part = VXM_BIN_NONE;
  for (size_t w = 0; w < job->bins->workers; w++)
    part = reader[w].part < part ? reader[w].part : part;
  return part;
}

static void flip_bitmap(vxm_coverage_flips *flips, size_t first, const vxm_crossing_bin_piece *piece) {
  for (size_t w = 0; w < piece->count; w++) {
    uint64_t places[64];
    size_t count = 0;
    for (uint64_t left = piece->data[w]; left; left &= left - 1)
      places[count++] = 64 * w + (uint64_t)__builtin_ctzll(left);
    vxm_coverage_flip(flips, first, places, count);
  }
}

/** The crossings of a part, of all threads: in any order, as only the voxels they lie in are folded. */
static void flip_part(const parity_job *job, vxm_coverage_flips *flips, size_t first,
                      vxm_crossing_bin_reader *reader, uint32_t part) {
  vxm_crossing_bin_piece piece;
  for (size_t w = 0; w < job->bins->workers; w++)
    while (reader[w].part == part && vxm_crossing_bin_next(&reader[w], &piece))
      if (piece.is_bitmap)
        flip_bitmap(flips, first, &piece);
      else
        vxm_coverage_flip(flips, first, piece.data, piece.count);
}

static void note_voxels(const parity_job *job, uint32_t part, const vxm_coverage_flips *flips) {
  atomic_uchar *has = job->pass->solid.has_voxels;
  if (has && !atomic_load_explicit(&has[part], memory_order_relaxed) && vxm_coverage_flips_any(flips))
    atomic_store_explicit(&has[part], 1, memory_order_relaxed);
}

/** All parts in the rows of a slice from `first` on. */
static void flip_rows(const parity_job *job, scratch *s, size_t slice, size_t first) {
  vxm_crossing_bin_reader reader[WORKERS_MAX];
  for (size_t w = 0; w < job->bins->workers; w++)
    reader[w] = vxm_crossing_bin_read(vxm_crossing_bins_at(job->bins, w, 0, slice), job->part_count == 1);
  vxm_coverage_flips *flips = &s->all;
  for (uint32_t part; (part = next_part(job, reader)) != VXM_BIN_NONE; flips = &s->part) {
    flip_part(job, flips, first, reader, part);
    note_voxels(job, part, flips);
    if (flips != &s->all)
      vxm_coverage_flips_unite(&s->all, flips);
  }
}

/** A slice of voxels. */
static void do_slice(size_t task, int worker, void *payload) {
  parity_job *job = payload;
  if (vxm_task_progress_stopped(&job->watch, worker))
    return;
  scratch *s = &job->scratch->of[worker];
  size_t some_rows = job->scratch->some_rows;
  vxm_coverage_writer writer;
  vxm_coverage_writer_begin(&writer, job->values, task * job->rows * job->shape.row_length,
                            &job->tallies[worker]);
  for (size_t row = 0; row < job->rows; row += some_rows) {
    size_t left = job->rows - row;
    flip_rows(job, s, task, row);
    vxm_coverage_put_rows(&s->all, left < some_rows ? left : some_rows, &writer);
  }
  vxm_coverage_writer_end(&writer);
  vxm_task_progress_step(&job->watch);
}

/* ---- All of it ---- */

/** For so many threads; what there is stays as it is. */
static vxm_status make_scratch(const parity_job *job, vxm_coverage_scratch **out, size_t count,
                               vxm_error *error) {
  vxm_context *context = job->pass->solid.context;
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_error local = VXM_ERROR_INIT;
  if (!*out) {
    *out = vxm_calloc(context, 1, sizeof **out + workers * sizeof(scratch), &local);
    if (*out) {
      (*out)->context = context;
      (*out)->some_rows = rows_at_once(context, &job->shape, job->rows);
    }
  }
  for (size_t w = *out ? (*out)->count : count; w < count && local.code == VXM_OK; w++) {
    scratch *s = &(*out)->of[w];
    s->all = s->part = job->shape;
    (*out)->count = w + 1;
    vxm_coverage_flips_make(&s->all, context, (*out)->some_rows, &local);
    if (job->part_count > 1)
      vxm_coverage_flips_make(&s->part, context, (*out)->some_rows, &local);
  }
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

void vxm_coverage_scratch_destroy(vxm_coverage_scratch *of) {
  if (!of)
    return;
  for (size_t w = 0; w < of->count; w++) {
    vxm_coverage_flips_free(&of->of[w].part, of->context);
    vxm_coverage_flips_free(&of->of[w].all, of->context);
  }
  vxm_free(of->context, of);
}

static vxm_status run(parity_job *job, const vxm_raster_schedule *crossings, vxm_coverage_scratch **kept,
                      vxm_error *error) {
  vxm_context *context = job->pass->solid.context;
  size_t slices = (size_t)(job->fine.end - job->fine.begin) / (size_t)job->values->n,
         workers = (size_t)vxm_context_threads(context);
  vxm_task_progress_start(&job->watch, context, "measuring coverage", crossings->range_count + slices, error);
  vxm_raster_schedule_run(crossings, 0, job->bins, &job->watch);
  vxm_status status = vxm_crossing_bins_check(job->bins, error);
  if (status == VXM_OK)
    status = make_scratch(job, kept, slices < workers ? slices : workers, error);
  job->scratch = *kept;
  if (status == VXM_OK && job->watch.status == VXM_OK)
    vxm_parallel(context, slices, do_slice, job);
  return status == VXM_OK ? vxm_task_progress_end(&job->watch) : status;
}

vxm_status vxm_coverage_parity(const vxm_coverage_values *values, vxm_model_pass *pass,
                               const vxm_window *fine, vxm_coverage_tally *tallies,
                               vxm_coverage_scratch **kept, bool *done, vxm_error *error) {
  const vxm_triangle_set *triangles = &pass->solid.analysis->triangles;
  vxm_workspace *workspace = pass->solid.workspace;
  int workers = vxm_context_threads(pass->solid.context), n = values->n;
  parity_job job = {
      .values = values, .pass = pass, .fine = *fine, .bins = &workspace->bins, .tallies = tallies};
  job.part_count = triangles->split.part_count;
  job.shape = vxm_coverage_flips_of(n, (size_t)(fine->fast_dim / n));
  job.rows = (size_t)(fine->middle_dim / n);
  vxm_columns columns = vxm_columns_of(fine, fine->layout.fast);
  columns.slab_shift = job.shape.shift;
  columns.step[fine->layout.slow] = UINT64_C(1) << job.shape.place_bits;
  columns.step[fine->layout.middle] = UINT64_C(1) << (job.shape.place_bits + job.shape.shift);
  columns.roles = VXM_ROLE_FACE | VXM_ROLE_CAP;
  columns.triangle_end = vxm_roles_end(triangles, triangles->split.part_count - 1, columns.roles);
  vxm_status status =
      vxm_raster_schedule_plan(&workspace->crossings, triangles, &pass->solid.placed, &columns, 1, error);
  *done = workspace->crossings.round_count <= 1;
  if (status != VXM_OK || !*done)
    return status;
  size_t slices = (size_t)(fine->end - fine->begin) / (size_t)n;
  uint64_t places = (uint64_t)job.rows << (job.shape.place_bits + 2 * job.shape.shift);
  status =
      vxm_crossing_bins_reset(&workspace->bins, (size_t)workers, 1, slices, (size_t)(places / 64 + 1), error);
  return status == VXM_OK ? run(&job, &workspace->crossings, kept, error) : status;
}
