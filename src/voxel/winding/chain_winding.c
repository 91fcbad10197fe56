/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/chain_winding.h"
#include "base/threads.h"
#include "voxel/winding/chain_sides.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

vxm_status vxm_chain_winding_place(vxm_chain_winding *out, const vxm_winding_chain *chain,
                                   const vxm_snapped_points *placed, int axis, bool mirrored,
                                   vxm_error *error) {
  vxm_context *context = out->context;
  size_t capacity = out->corner_capacity;
  vxm_status status =
      vxm_renew(context, (void **)&out->corners, &capacity, chain->closed_count, sizeof *out->corners, error);
  if (status == VXM_OK && (capacity > out->corner_capacity || !out->part)) {
    vxm_error local = VXM_ERROR_INIT;
    vxm_free(context, out->part);
    out->part = vxm_calloc(context, capacity, sizeof *out->part, &local); /* all one part: 0 */
    status = local.code;
    if (status != VXM_OK)
      vxm_error_pass(error, &local);
  }
  out->corner_capacity = out->part ? capacity : 0;
  if (status != VXM_OK)
    return status;
  size_t count = chain->closed_count;
  vxm_chain_sides sides = vxm_chain_sides_sort(out->corners, chain, placed, axis, mirrored);
  if (sides.left < count)
    memmove(out->corners + sides.entered, out->corners + sides.left,
            (count - sides.left) * sizeof *out->corners);
  out->estimate = sides.rows;
  out->entered = sides.entered;
  out->corner_count = sides.entered + count - sides.left;
  return VXM_OK;
}

/* ---- Crossings of a slab ---- */

typedef struct fold_state {
  vxm_chain_winding *out;
  vxm_window part; /**< slices of the window that are rastered at once */
  int64_t first;   /**< of these, counted from the window's first one */
  const vxm_kernels *kernels;
  vxm_slabs slabs;
  uint64_t by_row_words; /**< 2^40 / words of a row, rounded up; 0 where that is not good enough to divide */
  pthread_mutex_t mutex; /**< of `more`, `crossings` and `status` */
  vxm_status status;
  vxm_error error;
  vxm_task_progress progress;
} fold_state;

/** The place of a row's crossings is not known yet; of one that has some it is not known whether they are to
 * be kept. */
static const uint32_t to_count = UINT32_MAX, to_look_at = 1;

static void add_more(fold_state *state, size_t word, unsigned bit, int sign) {
  vxm_chain_winding *out = state->out;
  pthread_mutex_lock(&state->mutex);
  if (state->status == VXM_OK)
    state->status = vxm_grow(out->context, (void **)&out->more, &out->more_capacity, out->more_count + 1,
                             sizeof *out->more, &state->error);
  if (state->status == VXM_OK) {
    size_t row = word / out->window.row_words;
    out->more[out->more_count++] =
        (vxm_more_crossings){row, (int64_t)(64 * (word - row * out->window.row_words) + bit), sign};
    out->counted[row] = to_count;
  }
  pthread_mutex_unlock(&state->mutex);
}

/** Keeps the crossings of a row, which parity does not tell. */
static void keep_row(fold_state *state, size_t row, const uint64_t *enter, const uint64_t *leave) {
  vxm_chain_winding *out = state->out;
  size_t words = out->window.row_words;
  pthread_mutex_lock(&state->mutex);
  size_t number = out->crossing_count + 1;
  if (state->status == VXM_OK)
    state->status = vxm_grow(out->context, (void **)&out->crossings, &out->crossing_capacity,
                             2 * words * (number + 1), sizeof *out->crossings, &state->error);
  if (state->status == VXM_OK) {
    memcpy(out->crossings + 2 * words * number, enter, words * sizeof *enter);
    memcpy(out->crossings + 2 * words * number + words, leave, words * sizeof *leave);
    out->counted[row] = (uint32_t)number;
    out->crossing_count = number;
  }
  pthread_mutex_unlock(&state->mutex);
}

/** The row of a word of a slab. */
static inline size_t row_of(const fold_state *state, size_t word) {
  return state->by_row_words ? word * state->by_row_words >> 40 : word / state->out->window.row_words;
}

/** Sets the bits of the crossings of one kind, and marks their rows. @param first the slab's first word */
static void take_crossings(fold_state *state, size_t slab, int kind, uint64_t *bits, size_t first) {
  vxm_crossing_bins *bins = &state->out->bins[kind];
  uint32_t *counted = state->out->counted + first / state->out->window.row_words;
  for (size_t w = 0; w < bins->workers; w++) {
    vxm_crossing_bin_reader reader = vxm_crossing_bin_read(vxm_crossing_bins_at(bins, w, 0, slab), true);
    vxm_crossing_bin_piece piece;
    while (reader.part == 0 && vxm_crossing_bin_next(&reader, &piece))
      for (size_t i = 0; i < piece.count; i++) {
        size_t word = piece.data[i] / 64;
        uint64_t bit = UINT64_C(1) << (piece.data[i] % 64);
        if (bits[word] & bit)
          add_more(state, first + word, (unsigned)(piece.data[i] % 64), kind ? -1 : 1);
        bits[word] |= bit;
        counted[row_of(state, word)] |= to_look_at;
      }
  }
}

int64_t vxm_chain_winding_at(const vxm_chain_winding *counted, size_t row, int64_t voxel) {
  size_t words = counted->window.row_words;
  const uint64_t *enter = counted->crossings + 2 * words * counted->counted[row], *leave = enter + words;
  int64_t number = 0, w = 0;
  for (; w < voxel / 64; w++)
    number += vxm_popcount(enter[w]) - vxm_popcount(leave[w]);
  uint64_t mask = vxm_low_bits((unsigned)(voxel % 64) + 1);
  number += vxm_popcount(enter[w] & mask) - vxm_popcount(leave[w] & mask);
  size_t low = 0, high = counted->more_count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (counted->more[middle].row < row)
      low = middle + 1;
    else
      high = middle;
  }
  for (; low < counted->more_count && counted->more[low].row == row && counted->more[low].voxel <= voxel;
       low++)
    number += counted->more[low].sign;
  return number;
}

/** Whether parity tells the number in all of a row: entered where it becomes odd, left where it becomes even.
 */
static bool parity_tells(const uint64_t *bits, const uint64_t *enter, const uint64_t *leave, size_t words) {
  uint64_t wrong = 0;
  for (size_t w = 0; w < words; w++)
    wrong |= (enter[w] & ~leave[w] & ~bits[w]) | (leave[w] & ~enter[w] & bits[w]);
  return wrong == 0;
}

/** Folds rows of a slab that have crossings, and clears these. @param row the first of them, of the window */
static void fold_rows(fold_state *state, size_t row, size_t rows, uint64_t *enter, uint64_t *leave) {
  vxm_chain_winding *out = state->out;
  const size_t words = out->window.row_words;
  uint64_t *bits = out->window.words + row * words;
  for (size_t w = 0; w < rows * words; w++)
    bits[w] = enter[w] ^ leave[w];
  state->kernels->fold_rows(bits, words, rows, vxm_window_tail_mask(&out->window));
  for (size_t r = 0; r < rows; r++) {
    size_t at = r * words;
    if (out->counted[row + r] == to_look_at && parity_tells(bits + at, enter + at, leave + at, words))
      out->counted[row + r] = 0;
    else
      keep_row(state, row + r, enter + at, leave + at);
  }
  memset(enter, 0, rows * words * sizeof *enter);
  memset(leave, 0, rows * words * sizeof *leave);
}

static void fold_slab(size_t task, int worker, void *payload) {
  fold_state *state = payload;
  vxm_chain_winding *out = state->out;
  const vxm_window *window = &out->window;
  if (vxm_task_progress_stopped(&state->progress, worker))
    return;
  int64_t begin = state->first + ((int64_t)task << state->slabs.shift);
  int64_t end = vxm_min(begin + (INT64_C(1) << state->slabs.shift), state->first + state->slabs.layers);
  size_t first = (size_t)begin * window->slice_words, count = (size_t)(end - begin) * window->slice_words;
  size_t row = first / window->row_words, rows = (size_t)(end - begin) * (size_t)window->middle_dim;
  uint64_t *enter = out->slabs + 2 * (size_t)worker * state->slabs.words, *leave = enter + state->slabs.words;
  memset(window->words + first, 0, count * sizeof *window->words);
  memset(out->counted + row, 0, rows * sizeof *out->counted);
  take_crossings(state, task, 0, enter, first);
  take_crossings(state, task, 1, leave, first);
  for (size_t r = 0, next; r < rows; r = next) {
    for (next = r; next < rows && out->counted[row + next]; next++)
      ;
    if (next == r)
      next++;
    else
      fold_rows(state, row + r, next - r, enter + r * window->row_words, leave + r * window->row_words);
  }
  vxm_task_progress_step(&state->progress);
}

/** The bits of rows by counting. */
static void count_rows(size_t slice, int worker, void *payload) {
  (void)worker;
  vxm_chain_winding *out = payload;
  const vxm_window *window = &out->window;
  size_t rows = (size_t)window->middle_dim, words = window->row_words;
  for (size_t row = slice * rows; row < (slice + 1) * rows; row++) {
    if (!out->counted[row])
      continue;
    uint64_t *bits = window->words + row * words;
    const uint64_t *enter = out->crossings + 2 * words * out->counted[row], *leave = enter + words;
    int64_t number = 0;
    memset(bits, 0, words * sizeof *bits);
    for (int64_t i = 0; i < window->fast_dim; i++) {
      if ((enter[i / 64] | leave[i / 64]) >> (i % 64) & 1)
        number = vxm_chain_winding_at(out, row, i);
      bits[i / 64] |= (uint64_t)(number >= 1) << (i % 64);
    }
  }
}

static int compare_more(const void *a, const void *b) {
  const vxm_more_crossings *p = a, *q = b;
  if (p->row != q->row)
    return p->row < q->row ? -1 : 1;
  if (p->voxel != q->voxel)
    return p->voxel < q->voxel ? -1 : 1;
  return (p->sign > q->sign) - (p->sign < q->sign);
}

/* ---- All of it ---- */

/** Room for a window's words, its rows and two slabs for each worker. */
static vxm_status reserve(vxm_chain_winding *out, bool in_place, size_t slab_words, vxm_error *error) {
  vxm_window *window = &out->window;
  size_t depth = (size_t)(window->end - window->begin), rows = depth * (size_t)window->middle_dim;
  size_t slabs = 2 * (size_t)vxm_context_threads(out->context) * slab_words;
  vxm_status status = VXM_OK;
  if (!in_place) {
    status = vxm_renew(out->context, (void **)&out->words, &out->word_capacity, depth * window->slice_words,
                       sizeof *out->words, error);
    window->words = out->words;
  }
  if (status == VXM_OK)
    status = vxm_renew(out->context, (void **)&out->counted, &out->row_capacity, rows, sizeof *out->counted,
                       error);
  if (status != VXM_OK || slabs <= out->slab_capacity)
    return status;
  vxm_free(out->context, out->slabs);
  out->slabs = vxm_try_calloc(out->context, slabs, sizeof *out->slabs, &status, error);
  out->slab_capacity = out->slabs ? slabs : 0;
  return status;
}

/** Triangles whose crossings are put into bins. */
typedef struct raster_job {
  vxm_chain_winding *out;
  const vxm_snapped_points *placed;
  vxm_workspace *workspace;
  vxm_triangle_set triangles; /**< of the chain */
  vxm_columns columns;
} raster_job;

static raster_job job_of(vxm_chain_winding *out, vxm_workspace *workspace, const vxm_snapped_points *placed,
                         const vxm_columns *columns) {
  raster_job job = {out, placed, workspace, {.corners = out->corners, .part = out->part}, *columns};
  job.triangles.triangle_count = out->corner_count;
  job.columns.roles = VXM_ROLES_ALL | VXM_ROLE_CONE; /* some cross holes, and are as long as cones may be */
  return job;
}

/** Plans how the crossings of one kind are put into bins. */
static vxm_status plan(raster_job *job, int kind, vxm_error *error) {
  const vxm_chain_winding *out = job->out;
  job->columns.triangle_begin = kind ? out->entered : 0;
  job->columns.triangle_end = kind ? out->corner_count : out->entered;
  return vxm_raster_schedule_plan(&job->workspace->crossings, &job->triangles, job->placed, &job->columns, 1,
                                  error);
}

vxm_status vxm_chain_winding_steps(size_t *steps, vxm_chain_winding *out, vxm_workspace *workspace,
                                   const vxm_snapped_points *placed, const vxm_columns *columns,
                                   vxm_error *error) {
  raster_job job = job_of(out, workspace, placed, columns);
  vxm_status status = VXM_OK;
  *steps = 0;
  for (int kind = 0; kind < 2 && status == VXM_OK; kind++) {
    status = plan(&job, kind, error);
    *steps += workspace->crossings.range_count;
  }
  return status;
}

/** Puts the crossings of one kind into bins. */
static vxm_status raster(raster_job *job, int kind, size_t slabs, vxm_task_progress *progress,
                         vxm_error *error) {
  vxm_crossing_bins *bins = &job->out->bins[kind];
  /* A bin that becomes a bitmap forgets how often: never. */
  const size_t never = SIZE_MAX / 2;
  bins->context = job->out->context;
  vxm_status status =
      vxm_crossing_bins_reset(bins, (size_t)vxm_context_threads(job->out->context), 1, slabs, never, error);
  if (status == VXM_OK)
    status = plan(job, kind, error);
  if (status == VXM_OK && job->columns.triangle_begin < job->columns.triangle_end)
    vxm_raster_schedule_run(&job->workspace->crossings, 0, bins, progress);
  return status == VXM_OK ? vxm_crossing_bins_check(bins, error) : status;
}

vxm_status vxm_chain_winding_raster(vxm_chain_winding *out, vxm_workspace *workspace,
                                    const vxm_snapped_points *placed, const vxm_columns *columns,
                                    size_t slabs, vxm_task_progress *progress, vxm_error *error) {
  raster_job job = job_of(out, workspace, placed, columns);
  vxm_status status = VXM_OK;
  for (int kind = 0; kind < 2 && status == VXM_OK && progress->status == VXM_OK; kind++)
    status = raster(&job, kind, slabs, progress, error);
  return status;
}

/** Counts in some slices. */
static vxm_status fill_part(fold_state *state, vxm_workspace *workspace, const vxm_snapped_points *placed,
                            vxm_error *error) {
  vxm_chain_winding *out = state->out;
  size_t steps;
  vxm_columns columns = vxm_columns_of(&state->part, state->part.layout.fast);
  columns.slab_shift = state->slabs.shift;
  vxm_status status = vxm_chain_winding_steps(&steps, out, workspace, placed, &columns, error);
  vxm_task_progress_start(&state->progress, out->context, "counting crossings", steps + state->slabs.count,
                          error);
  if (status == VXM_OK)
    status = vxm_chain_winding_raster(out, workspace, placed, &columns, state->slabs.count, &state->progress,
                                      error);
  if (status != VXM_OK)
    return status;
  if (state->progress.status == VXM_OK)
    vxm_parallel(out->context, state->slabs.count, fold_slab, state);
  if (state->status != VXM_OK) {
    vxm_error_pass(error, &state->error);
    return state->status;
  }
  return vxm_task_progress_end(&state->progress);
}

/** Slices whose crossings are held at once: all, unless there are very many. */
static int64_t slices_at_once(const vxm_chain_winding *out, int64_t depth) {
  double most = vxm_raster_schedule_round(out->context);
  return out->estimate <= most ? depth : vxm_max((int64_t)((double)depth * most / out->estimate), 1);
}

vxm_status vxm_chain_winding_fill(vxm_chain_winding *out, vxm_workspace *workspace,
                                  const vxm_snapped_points *placed, const vxm_window *window, bool in_place,
                                  vxm_error *error) {
  out->window = *window;
  in_place &= window->slice_words == window->row_words * (size_t)window->middle_dim;
  out->window.slice_words = window->row_words * (size_t)window->middle_dim;
  out->more_count = out->crossing_count = 0;
  int64_t depth = window->end - window->begin, slices = slices_at_once(out, depth);
  fold_state state = {.out = out, .kernels = vxm_kernels_get(), .error = VXM_ERROR_INIT};
  state.slabs = vxm_slabs_of(slices, out->window.slice_words, vxm_context_threads(out->context));
  /* A slab has at most 2^20 rows, so words below row_words << 20: the error is below their square >> 20. */
  if (window->row_words <= 1 << 10)
    state.by_row_words = ((UINT64_C(1) << 40) + window->row_words - 1) / window->row_words;
  vxm_status status = reserve(out, in_place, state.slabs.words, error);
  if (status != VXM_OK)
    return status;
  pthread_mutex_init(&state.mutex, NULL);
  for (int64_t begin = 0; begin < depth && status == VXM_OK; begin += slices) {
    vxm_progress_part whole =
        vxm_progress_enter((double)begin / (double)depth, fmin((double)(begin + slices) / (double)depth, 1));
    state.first = begin;
    state.part = out->window;
    state.part.begin += begin;
    state.part.end = vxm_min(state.part.begin + slices, window->end);
    state.slabs.layers = state.part.end - state.part.begin;
    state.slabs.count =
        (size_t)((state.slabs.layers + (INT64_C(1) << state.slabs.shift) - 1) >> state.slabs.shift);
    status = fill_part(&state, workspace, placed, error);
    vxm_progress_leave(whole);
  }
  pthread_mutex_destroy(&state.mutex);
  if (status != VXM_OK || out->crossing_count == 0)
    return status;
  if (out->more_count > 0)
    qsort(out->more, out->more_count, sizeof *out->more, compare_more);
  return vxm_parallel_cancellable(out->context, (size_t)depth, count_rows, out, error);
}

void vxm_chain_winding_destroy(vxm_chain_winding *counted) {
  vxm_context *context = counted->context;
  for (int kind = 0; kind < 2; kind++)
    vxm_crossing_bins_destroy(&counted->bins[kind]);
  vxm_free(context, counted->part);
  vxm_free(context, counted->corners);
  vxm_free(context, counted->more);
  vxm_free(context, counted->crossings);
  vxm_free(context, counted->counted);
  vxm_free(context, counted->slabs);
  vxm_free(context, counted->words);
  *counted = (vxm_chain_winding){.context = context};
}
