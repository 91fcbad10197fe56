/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Small windows are drawn without tiles: on one thread into the window itself, in the order of the mesh,
 * which mostly goes from place to place; on several, each but the first has a window of its own, and all are
 * joined.
 */
#include "base/threads.h"
#include "voxel/surface/surface_tiles.h"

#include <string.h>

enum {
  DIRECT_WORDS = 1 << 22, /**< windows up to this that one thread draws into: 32 MiB */
  COPIED_WORDS = 1 << 19, /**< windows of their own for all threads: vxm_surface_bytes has them */
  TRIANGLES = 4096        /**< that one task draws */
};

typedef struct direct_job {
  vxm_surface_pen pen; /**< that of the first thread */
  size_t rows, padded; /**< room for rows of one thread */
  size_t words;        /**< of a thread's own window, without gaps between slices */
  size_t copy_count;   /**< threads that have a task, but for the first */
  uint64_t *copies;    /**< their windows */
  bool is_fresh;
  size_t tasks;
  vxm_task_progress progress;
} direct_job;

static size_t rows_words(const vxm_window *window) {
  return window->row_words * (size_t)window->middle_dim;
}

static void draw_task(size_t task, int worker, void *payload) {
  direct_job *job = payload;
  if (vxm_task_progress_stopped(&job->progress, worker))
    return;
  vxm_surface_pen pen = job->pen;
  size_t count = pen.surface->triangle_count;
  pen.rows += (size_t)worker * job->rows;
  pen.row_begin += (size_t)worker * 2 * job->padded;
  pen.row_end = pen.row_begin + job->padded;
  if (worker > 0) {
    pen.words = job->copies + (size_t)(worker - 1) * job->words;
    pen.slice_words = rows_words(pen.window);
  }
  vxm_surface_draw_some(&pen, NULL, vxm_slice_begin(count, job->tasks, task),
                        vxm_slice_begin(count, job->tasks, task + 1), &job->progress, worker);
  vxm_task_progress_step(&job->progress);
}

/** Clears a slice of all windows. */
static void clear_task(size_t slice, int worker, void *payload) {
  (void)worker;
  const direct_job *job = payload;
  const vxm_window *window = job->pen.window;
  size_t count = rows_words(window);
  if (job->is_fresh)
    memset(vxm_window_row(window, 0, window->begin + (int64_t)slice), 0, count * sizeof *window->words);
  for (size_t i = 0; i < job->copy_count; i++)
    memset(job->copies + i * job->words + slice * count, 0, count * sizeof *job->copies);
}

/** Joins a slice of all windows. */
static void join_task(size_t slice, int worker, void *payload) {
  (void)worker;
  const direct_job *job = payload;
  const vxm_window *window = job->pen.window;
  size_t count = rows_words(window);
  for (size_t i = 0; i < job->copy_count; i++)
    job->pen.build->join(vxm_window_row(window, 0, window->begin + (int64_t)slice),
                         job->copies + i * job->words + slice * count, count);
}

static vxm_status draw_all(direct_job *job) {
  vxm_context *context = job->progress.context;
  size_t slices = (size_t)(job->pen.window->end - job->pen.window->begin);
  if (job->copies)
    vxm_parallel(context, slices, clear_task, job);
  for (size_t s = 0; s < slices && !job->copies; s++)
    clear_task(s, 0, job); /* into the cache of the thread that draws */
  vxm_parallel(context, job->tasks, draw_task, job);
  if (job->progress.status == VXM_OK && job->copies)
    vxm_parallel(context, slices, join_task, job);
  return job->progress.status == VXM_OK ? vxm_task_progress_end(&job->progress) : job->progress.status;
}

static vxm_status add_directly(const vxm_surface_pen *pen, bool is_fresh, vxm_error *error) {
  const vxm_window *window = pen->window;
  vxm_context *context = pen->surface->context;
  vxm_error local = VXM_ERROR_INIT;
  size_t workers = (size_t)vxm_context_threads(context);
  direct_job job = {.pen = *pen,
                    .rows = (size_t)window->middle_dim,
                    .is_fresh = is_fresh,
                    .words = (size_t)(window->end - window->begin) * rows_words(window),
                    .tasks = 1 + pen->surface->triangle_count / TRIANGLES};
  job.padded = job.rows + (size_t)2 * VXM_SURFACE_LANES;
  job.pen.words = window->words;
  job.pen.slice_words = window->slice_words;
  vxm_task_progress_start(&job.progress, context, "voxelizing the surface", job.tasks, &local);
  job.pen.rows = vxm_alloc(context, workers * job.rows, sizeof *job.pen.rows, &local);
  job.pen.row_begin = vxm_calloc(context, workers * 2 * job.padded, sizeof *job.pen.row_begin, &local);
  job.copy_count = (workers < job.tasks ? workers : job.tasks) - 1;
  if (job.copy_count > 0)
    job.copies = vxm_alloc(context, job.copy_count * job.words, sizeof *job.copies, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = draw_all(&job);
  vxm_free(context, job.copies);
  vxm_free(context, job.pen.row_begin);
  vxm_free(context, job.pen.rows);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_surface_add(const vxm_surface *surface, const vxm_window *window, vxm_surface_kind kind,
                           bool is_fresh, vxm_error *error) {
  if (window->begin >= window->end)
    return VXM_OK;
  vxm_surface_pen pen = vxm_surface_pen_of(surface, window, kind);
  size_t words = (size_t)(window->end - window->begin) * window->slice_words;
  size_t others = (size_t)vxm_context_threads(surface->context) - 1;
  bool is_small = others == 0 ? words <= DIRECT_WORDS : words <= COPIED_WORDS / others;
  return is_small ? add_directly(&pen, is_fresh, error) : vxm_surface_add_tiled(&pen, is_fresh, error);
}
