/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/coverage_parity.h"
#include "base/threads.h"
#include "voxel/fields/coverage_flips.h"
#include "voxel/model/model.h"
#include "voxel/solid/self_overlap_fill.h"
#include "voxel/winding/chain_flips.h"

/** What a thread works with: the flips of the rows at hand, and those of a part beside others, of which none
 * are left from one slice to the next; and those of parts that lie in themselves. */
typedef struct scratch {
  vxm_coverage_flips all, part;
  vxm_chain_flips wound;
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
  vxm_columns columns;
  vxm_chain_winding *chain; /**< of parts that lie in themselves; NULL = there are none */
  atomic_int failed;        /**< a vxm_status */
  vxm_task_progress progress;
} parity_job;

bool vxm_coverage_by_parity(const vxm_model_pass *pass) {
  const vxm_voxelize_options *options = &pass->solid.options;
  return options->mode == VXM_MODE_SOLID && options->method == VXM_METHOD_VOTE &&
         !vxm_voxel_pass_ops(&pass->solid) && !vxm_votes_wanted(pass->solid.analysis, options);
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
  bool overlaps = vxm_overlaps_wanted(&model->analysis, &model->options);
  uint64_t ends = overlaps ? (uint64_t)rows * (unsigned)n * (unsigned)n * sizeof(uint32_t) : 0;
  return ends + (overlaps || model->analysis.triangles.split.part_count > 1 ? 2 * bytes : bytes);
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

/** What parts that lie in themselves are wound around, as of a part more. */
static void flip_wound(const parity_job *job, scratch *s, vxm_coverage_flips *flips, size_t first) {
  vxm_coverage_flip(flips, first, s->wound.places, s->wound.count);
  if (flips == &s->all ? vxm_coverage_flips_any(flips) : vxm_coverage_flips_unite(&s->all, flips))
    vxm_self_overlap_note(&job->pass->solid);
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
  if (job->chain)
    flip_wound(job, s, flips, first);
}

/** The flips of parts that lie in themselves, in a slice. */
static bool take_wound(parity_job *job, scratch *s, size_t slice) {
  if (!job->chain)
    return true;
  size_t rows = job->rows << 2 * job->shape.shift;
  vxm_status status = vxm_chain_flips_take(&s->wound, job->chain, slice, rows, job->shape.place_bits);
  if (status != VXM_OK)
    atomic_store_explicit(&job->failed, (int)status, memory_order_relaxed);
  return status == VXM_OK;
}

/** A slice of voxels. */
static void do_slice(size_t task, int worker, void *payload) {
  parity_job *job = payload;
  if (vxm_task_progress_stopped(&job->progress, worker))
    return;
  scratch *s = &job->scratch->of[worker];
  size_t some_rows = job->scratch->some_rows;
  if (!take_wound(job, s, task))
    return;
  vxm_coverage_writer writer;
  vxm_coverage_writer_begin(&writer, job->values, task * job->rows * job->shape.row_length,
                            &job->tallies[worker]);
  for (size_t row = 0; row < job->rows; row += some_rows) {
    size_t left = job->rows - row;
    flip_rows(job, s, task, row);
    vxm_coverage_put_rows(&s->all, left < some_rows ? left : some_rows, &writer);
  }
  vxm_coverage_writer_end(&writer);
  vxm_task_progress_step(&job->progress);
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
    if (job->part_count > 1 || job->chain)
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
    vxm_coverage_flips_destroy(&of->of[w].part, of->context);
    vxm_coverage_flips_destroy(&of->of[w].all, of->context);
    vxm_chain_flips_destroy(&of->of[w].wound, of->context);
  }
  vxm_free(of->context, of);
}

/** Puts the crossings of parts that lie in themselves into their bins. */
static vxm_status raster_chain(parity_job *job, size_t slices, vxm_error *error) {
  if (!job->chain || job->progress.status != VXM_OK)
    return VXM_OK;
  return vxm_chain_winding_raster(job->chain, job->pass->solid.workspace, &job->pass->solid.placed,
                                  &job->columns, slices, &job->progress, error);
}

static vxm_status check_slices(parity_job *job, vxm_error *error) {
  int failed = atomic_load_explicit(&job->failed, memory_order_relaxed);
  return failed == VXM_OK ? VXM_OK
                          : vxm_fail(error, (vxm_status)failed, "coverage: the memory for crossings ran out");
}

/** The steps of what is rastered are `raster_steps`. */
static vxm_status run(parity_job *job, size_t raster_steps, vxm_coverage_scratch **kept, vxm_error *error) {
  vxm_context *context = job->pass->solid.context;
  size_t slices = (size_t)(job->fine.end - job->fine.begin) / (size_t)job->values->n,
         workers = (size_t)vxm_context_threads(context);
  vxm_task_progress_start(&job->progress, context, "measuring coverage", raster_steps + slices, error);
  vxm_raster_schedule_run(&job->pass->solid.workspace->crossings, 0, job->bins, &job->progress);
  vxm_status status = vxm_crossing_bins_check(job->bins, error);
  if (status == VXM_OK)
    status = raster_chain(job, slices, error);
  if (status == VXM_OK)
    status = make_scratch(job, kept, slices < workers ? slices : workers, error);
  job->scratch = *kept;
  if (status == VXM_OK && job->progress.status == VXM_OK)
    vxm_parallel(context, slices, do_slice, job);
  if (status == VXM_OK)
    status = check_slices(job, error);
  return status == VXM_OK ? vxm_task_progress_end(&job->progress) : status;
}

/** The chain of parts that lie in themselves, if there are any: placed, and its steps; `*few` becomes false
 * if there may be more crossings than are held at once. */
static vxm_status plan_chain(parity_job *job, size_t *steps, bool *few, vxm_error *error) {
  vxm_voxel_pass *solid = &job->pass->solid;
  *steps = 0;
  *few = true;
  if (!vxm_overlaps_wanted(solid->analysis, &solid->options))
    return VXM_OK;
  vxm_status status = vxm_self_overlap_place(solid, job->fine.layout.fast, error);
  if (status != VXM_OK)
    return status;
  job->chain = &solid->overlap_winding;
  double share = (double)(job->fine.end - job->fine.begin) / (double)job->fine.slow_dim;
  *few = job->chain->estimate * share <= vxm_raster_schedule_round(solid->context);
  return vxm_chain_winding_steps(steps, job->chain, solid->workspace, &solid->placed, &job->columns, error);
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
  job.columns = vxm_columns_of(fine, fine->layout.fast);
  job.columns.slab_shift = job.shape.shift;
  job.columns.step[fine->layout.slow] = UINT64_C(1) << job.shape.place_bits;
  job.columns.step[fine->layout.middle] = UINT64_C(1) << (job.shape.place_bits + job.shape.shift);
  job.columns.roles = VXM_ROLE_FACE | VXM_ROLE_CAP;
  job.columns.triangle_end = vxm_roles_end(triangles, triangles->split.part_count - 1, job.columns.roles);
  size_t of_chain;
  bool few;
  vxm_status status = plan_chain(&job, &of_chain, &few, error);
  if (status == VXM_OK)
    status = vxm_raster_schedule_plan(&workspace->crossings, triangles, &pass->solid.placed, &job.columns, 1,
                                      error);
  *done = few && workspace->crossings.round_count <= 1;
  if (status != VXM_OK || !*done)
    return status;
  size_t slices = (size_t)(fine->end - fine->begin) / (size_t)n;
  uint64_t places = (uint64_t)job.rows << (job.shape.place_bits + 2 * job.shape.shift);
  status =
      vxm_crossing_bins_reset(&workspace->bins, (size_t)workers, 1, slices, (size_t)(places / 64 + 1), error);
  return status == VXM_OK ? run(&job, of_chain + workspace->crossings.range_count, kept, error) : status;
}
