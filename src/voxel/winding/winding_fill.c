/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_fill.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "voxel/winding/winding_settle.h"

#include <string.h>

/** A cell that is a task of its own. */
typedef struct cell_task {
  int64_t origin[3];
  float samples[VXM_BRICK];
  size_t list, count; /**< in the list of nodes of all tasks */
} cell_task;

typedef struct fill_job {
  vxm_winding_asking asking; /**< the first, so that what is called back finds the rest */
  int top;                   /**< the level of which one cell holds all of the grid */
  cell_task *tasks;
  size_t task_count, task_capacity;
  vxm_winding_scratch lists;    /**< of all tasks */
  vxm_winding_scratch *scratch; /**< of each worker */
  vxm_task_progress progress;
} fill_job;

/* ---- The walk ---- */

static void hand_on(const vxm_winding_walk *walk, vxm_winding_scratch *scratch, const int64_t origin[3],
                    const float samples[VXM_BRICK], size_t list, size_t count) {
  fill_job *job = (fill_job *)(void *)walk; /* the walk is its own, and but one thread walks so far */
  if (scratch->status == VXM_OK)
    scratch->status = vxm_grow(scratch->context, (void **)&job->tasks, &job->task_capacity,
                               job->task_count + 1, sizeof *job->tasks, &scratch->error);
  if (scratch->status != VXM_OK)
    return;
  cell_task *task = &job->tasks[job->task_count++];
  *task = (cell_task){.list = job->lists.count, .count = count};
  memcpy(task->origin, origin, sizeof task->origin);
  memcpy(task->samples, samples, sizeof task->samples);
  for (size_t i = 0; i < count; i++)
    vxm_winding_scratch_add(&job->lists, scratch->nodes[list + i]);
  if (job->lists.status != VXM_OK) {
    scratch->status = job->lists.status;
    scratch->error = job->lists.error;
  }
}

static void walk_task(size_t index, int worker, void *payload) {
  fill_job *job = payload;
  vxm_winding_scratch *scratch = &job->scratch[worker];
  const cell_task *task = &job->tasks[index];
  if (scratch->status != VXM_OK || vxm_task_progress_stopped(&job->progress, worker))
    return;
  scratch->count = 0;
  for (size_t i = 0; i < task->count; i++)
    vxm_winding_scratch_add(scratch, job->lists.nodes[task->list + i]);
  if (scratch->status == VXM_OK)
    job->asking.kernels->descend(&job->asking.walk, scratch, task->origin, job->asking.walk.task_level,
                                 task->samples, 0, task->count);
  vxm_task_progress_step(&job->progress);
}

/** Walks down to the cells that are tasks, then through these in all threads. */
static vxm_status walk(fill_job *job, int top, vxm_error *error) {
  static const int64_t origin[3] = {0, 0, 0};
  static const float nothing[VXM_BRICK] = {0};
  enum { LEVELS_BEFORE = 3 }; /* up to 512 tasks */
  vxm_context *context = job->asking.mesh->context;
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_winding_scratch *first = &job->scratch[0];
  job->task_count = 0;
  job->lists.count = 0;
  job->asking.walk.task_level = top > LEVELS_BEFORE ? top - LEVELS_BEFORE : 0;
  job->asking.walk.hand_on = hand_on;
  first->count = 0;
  for (size_t r = 0; r < job->asking.mesh->tree.root_count; r++)
    vxm_winding_scratch_add(first, job->asking.mesh->tree.roots[r]);
  if (first->status == VXM_OK && vxm_winding_wants(&job->asking.walk, origin, top))
    job->asking.kernels->descend(&job->asking.walk, first, origin, top, nothing, 0,
                                 job->asking.mesh->tree.root_count);
  job->asking.walk.hand_on = NULL;
  if (first->status != VXM_OK) {
    vxm_error_pass(error, &first->error);
    return first->status;
  }
  vxm_task_progress_start(&job->progress, context, "computing winding numbers", job->task_count, error);
  vxm_parallel(context, job->task_count, walk_task, job);
  for (size_t w = 0; w < workers; w++)
    if (job->scratch[w].status != VXM_OK) {
      vxm_error_pass(error, &job->scratch[w].error);
      return job->scratch[w].status;
    }
  return vxm_task_progress_end(&job->progress);
}

/* ---- What is asked, and what comes of it ---- */

/** The words of up to four rows of up to four slices together. */
static uint64_t any_of(const uint64_t *words, const vxm_window *window, int64_t slices, int64_t rows) {
  uint64_t any = 0;
  size_t row = window->row_words;
  for (int64_t s = 0; s < slices; s++, words += window->slice_words)
    if (rows == 4)
      any |= words[0] | words[row] | words[2 * row] | words[3 * row];
    else
      for (int64_t r = 0; r < rows; r++)
        any |= words[(size_t)r * row];
  return any;
}

/** Marks the bricks of four slices by the rows of each together. */
static void mark_asked_slice(size_t layer, int worker, void *payload) {
  (void)worker;
  const fill_job *job = payload;
  const vxm_window *window = job->asking.window;
  const vxm_brick_mask *mask = &job->asking.mesh->asked;
  const ptrdiff_t step[3] = {1, (ptrdiff_t)mask->count[0][0],
                             (ptrdiff_t)(mask->count[0][0] * mask->count[0][1])};
  int64_t base = window->begin / VXM_BRICK_SIDE * VXM_BRICK_SIDE + VXM_BRICK_SIDE * (int64_t)layer, at[3];
  int64_t s_begin = vxm_max(base, window->begin), s_end = vxm_min(base + VXM_BRICK_SIDE, window->end);
  at[window->layout.slow] = s_begin;
  for (int64_t m = 0; m < window->middle_dim && s_begin < s_end; m += VXM_BRICK_SIDE) {
    const uint64_t *words = job->asking.asked + (size_t)(s_begin - window->begin) * window->slice_words +
                            (size_t)m * window->row_words;
    int64_t rows = vxm_min(VXM_BRICK_SIDE, window->middle_dim - m);
    at[window->layout.middle] = m;
    for (size_t w = 0; w < window->row_words; w++) {
      uint64_t any = any_of(words + w, window, s_end - s_begin, rows);
      if (!any)
        continue;
      at[window->layout.fast] = 64 * (int64_t)w;
      uint8_t *cell = vxm_brick_mask_at(mask, at, 0);
      for (; any; any &= ~(UINT64_C(15) << (__builtin_ctzll(any) & ~3)))
        cell[__builtin_ctzll(any) / VXM_BRICK_SIDE * step[window->layout.fast]] = 1;
    }
  }
}

typedef struct merge_state {
  const fill_job *job;
  atomic_bool added;
} merge_state;

/** Adds what was asked about and is inside to the window. */
static void merge_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  merge_state *state = payload;
  const fill_job *job = state->job;
  const vxm_window *window = job->asking.window, *from = vxm_winding_decided(&job->asking);
  uint64_t *to = window->words + slice * window->slice_words, added = 0;
  const uint64_t *bits = from->words + slice * from->slice_words,
                 *asked = job->asking.asked ? job->asking.asked + slice * window->slice_words : NULL;
  for (size_t w = 0; w < from->slice_words; w++) {
    if (asked && !asked[w]) /* nearly everywhere */
      continue;
    uint64_t inside = asked ? bits[w] & asked[w] : bits[w];
    added |= inside & ~(asked ? to[w] : 0);
    to[w] = asked ? to[w] | inside : inside;
  }
  if (added)
    atomic_store_explicit(&state->added, true, memory_order_relaxed);
}

/** The voxels about which the trees are asked, if there are any. */
static vxm_status decide_by_tree(fill_job *job, vxm_error *error) {
  vxm_winding_mesh *mesh = job->asking.mesh;
  vxm_context *context = mesh->context;
  size_t depth = (size_t)(job->asking.window->end - job->asking.window->begin);
  vxm_status status =
      vxm_brick_mask_begin(&mesh->doubted, job->asking.begin, job->asking.end, job->top + 1, error);
  if (status == VXM_OK && job->asking.asked) {
    status = vxm_brick_mask_begin(&mesh->asked, job->asking.begin, job->asking.end, job->top + 1, error);
    if (status == VXM_OK)
      status = vxm_parallel_cancellable(context, (depth + 6) / 4, mark_asked_slice, job, error);
    job->asking.is_asked = true;
    if (status != VXM_OK || !vxm_brick_mask_raise(&mesh->asked))
      return status;
  }
  if (status == VXM_OK)
    status = walk(job, job->top, error);
  if (status != VXM_OK || !vxm_brick_mask_raise(&mesh->doubted))
    return status;
  job->asking.walk.strict = true;
  job->asking.walk.doubt = VXM_WINDING_STRICT_DOUBT;
  return walk(job, job->top, error);
}

vxm_status vxm_winding_fill(vxm_winding_mesh *mesh, const vxm_window *window, const uint64_t *asked,
                            uint8_t *confidence, vxm_workspace *workspace, bool *added, vxm_error *error) {
  if (window->begin >= window->end)
    return VXM_OK;
  vxm_status status = vxm_chain_winding_fill(&mesh->closed, workspace, mesh->placed, window, !asked, error);
  if (status != VXM_OK)
    return status;
  fill_job job = {.asking = {.walk = {.tree = &mesh->tree,
                                      .levels = vxm_winding_levels(),
                                      .doubt = VXM_WINDING_DOUBT,
                                      .whole = confidence != NULL,
                                      .wants = vxm_winding_wants,
                                      .settle_cell = vxm_winding_settle_cell,
                                      .settle_brick = vxm_winding_settle_brick},
                             .mesh = mesh,
                             .window = window,
                             .asked = asked,
                             .confidence = confidence,
                             .is_alone = vxm_context_threads(mesh->context) == 1,
                             .kernels = vxm_winding_kernels_get()}};
  job.asking.end[window->layout.fast] = window->fast_dim;
  job.asking.end[window->layout.middle] = window->middle_dim;
  job.asking.begin[window->layout.slow] = window->begin;
  job.asking.end[window->layout.slow] = window->end;
  int64_t longest = vxm_max(vxm_max(window->fast_dim, window->middle_dim), window->slow_dim);
  while (INT64_C(4) << job.top < longest)
    job.top++;
  vxm_context *context = mesh->context;
  size_t workers = (size_t)vxm_context_threads(context);
  job.lists = (vxm_winding_scratch){.context = context, .error = VXM_ERROR_INIT};
  job.scratch = vxm_try_calloc(context, workers, sizeof *job.scratch, &status, error);
  if (!job.scratch)
    return status;
  for (size_t w = 0; w < workers; w++)
    job.scratch[w] = (vxm_winding_scratch){.context = context, .error = VXM_ERROR_INIT};
  if (mesh->tree.count > 0 || confidence)
    status = decide_by_tree(&job, error);
  for (size_t w = 0; w < workers; w++)
    vxm_free(context, job.scratch[w].nodes);
  vxm_free(context, job.scratch);
  vxm_free(context, job.lists.nodes);
  vxm_free(context, job.tasks);
  if (status != VXM_OK)
    return status;
  if (vxm_winding_decided(&job.asking)->words == window->words) {
    *added |= !vxm_words_are_zero(window->words, window->slice_words * (size_t)(window->end - window->begin));
    return VXM_OK;
  }
  merge_state state = {.job = &job};
  atomic_init(&state.added, false);
  vxm_parallel(context, (size_t)(window->end - window->begin), merge_slice, &state);
  *added |= atomic_load(&state.added);
  return VXM_OK;
}
