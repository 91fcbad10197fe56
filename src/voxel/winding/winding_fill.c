/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_fill.h"
#include "base/task_progress.h"
#include "base/threads.h"
#include "voxel/winding/winding_exact.h"
#include "voxel/winding/winding_walk.h"

#include <math.h>
#include <string.h>

/** Bricks this close to a half are looked at again, voxels this close to it after that by doubles. */
static const float doubt = 0.008F, strict_doubt = 3e-4F;
/** Winding numbers this close to a half are taken for it. */
static const double tie = 1e-6;

/** A cell that is a task of its own. */
typedef struct cell_task {
  int64_t origin[3];
  float samples[VXM_BRICK];
  size_t list, count; /**< in the list of nodes of all tasks */
} cell_task;

typedef struct fill_job {
  vxm_winding_walk walk; /**< the first, so that what is called back finds the rest */
  vxm_winding_mesh *mesh;
  const vxm_window *window;
  const uint64_t *asked;
  uint8_t *confidence;
  int64_t begin[3], end[3]; /**< the voxels of the window along x, y, z */
  int top;                  /**< the level of which one cell holds all of the grid */
  bool is_asked;            /**< mesh->asked says which cells are */
  bool is_alone;            /**< one thread works */
  const vxm_winding_kernels *kernels;
  cell_task *tasks;
  size_t task_count, task_capacity;
  vxm_winding_scratch lists;    /**< of all tasks */
  vxm_winding_scratch *scratch; /**< of each worker */
  vxm_task_progress watch;
} fill_job;

static const fill_job *job_of(const vxm_winding_walk *walk) {
  return (const fill_job *)(const void *)walk;
}

/* ---- Settling ---- */

/** The window of what is decided, which begins as the winding number of the closed chain. */
static const vxm_window *decided(const fill_job *job) {
  return &job->mesh->closed.window;
}

static bool wants(const vxm_winding_walk *walk, const int64_t origin[3], int level) {
  const fill_job *job = job_of(walk);
  int64_t side = INT64_C(4) << level;
  for (int a = 0; a < 3; a++)
    if (origin[a] >= job->end[a] || origin[a] + side <= job->begin[a])
      return false;
  const uint8_t *doubted = walk->strict ? vxm_brick_mask_at(&job->mesh->doubted, origin, level) : NULL;
  if (walk->strict && !(doubted && *doubted))
    return false;
  const uint8_t *asked = job->is_asked ? vxm_brick_mask_at(&job->mesh->asked, origin, level) : NULL;
  return !job->is_asked || (asked && *asked);
}

/** Turns bits of a word over. */
static void flip(const fill_job *job, uint64_t *word, uint64_t change) {
  if (!change)
    return;
  if (job->is_alone)
    *word ^= change;
  else /* other threads may change other bits */
    __atomic_fetch_xor(word, change, __ATOMIC_RELAXED);
}

/** Bits of a word become those of `bits`. */
static void store_word(const fill_job *job, uint64_t *word, uint64_t bits, uint64_t mask) {
  flip(job, word, (__atomic_load_n(word, __ATOMIC_RELAXED) ^ bits) & mask);
}

/** Bits first..first+count-1 of a row become `bits`. */
static void store_bits(const fill_job *job, uint64_t *row, int64_t first, int64_t count, uint64_t bits) {
  for (int64_t done = 0; done < count;) {
    int64_t at = first + done, n = vxm_min(count - done, 64 - at % 64);
    store_word(job, row + at / 64, bits >> done << (at % 64), vxm_low_bits((unsigned)n) << (at % 64));
    done += n;
  }
}

/** The number of the closed chain at up to 64 voxels of a row, plus `number`: whether it is at least 1. */
static uint64_t at_least_one(const fill_job *job, size_t row, int64_t first, int64_t count, int number) {
  const vxm_chain_winding *closed = &job->mesh->closed;
  uint64_t bits = 0;
  if (!closed->counted[row])
    return number > 0 ? ~UINT64_C(0) : 0; /* it is 0 or 1, and number is not 0 */
  for (int64_t i = 0; i < count; i++)
    bits |= (uint64_t)(vxm_chain_winding_at(closed, row, first + i) + number >= 1) << i;
  return bits;
}

/** Where the voxels of a cell lie in the window: its first ones along the fast, middle and slow axis, and how
 * many. */
static void clip(const fill_job *job, const int64_t origin[3], int64_t side, int64_t first[3],
                 int64_t count[3]) {
  const int axis[3] = {job->window->layout.fast, job->window->layout.middle, job->window->layout.slow};
  for (int i = 0; i < 3; i++) {
    int a = axis[i];
    first[i] = vxm_max(origin[a], job->begin[a]);
    count[i] = vxm_min(origin[a] + side, job->end[a]) - first[i];
  }
}

static size_t row_of(const fill_job *job, int64_t middle, int64_t slow) {
  return (size_t)(slow - job->window->begin) * (size_t)job->window->middle_dim + (size_t)middle;
}

static void settle_cell(const vxm_winding_walk *walk, const int64_t origin[3], int level, int number) {
  const fill_job *job = job_of(walk);
  const vxm_window *out = decided(job);
  int64_t first[3], count[3];
  if (number == 0)
    return; /* as the closed chain says */
  clip(job, origin, INT64_C(4) << level, first, count);
  for (int64_t s = first[2]; s < first[2] + count[2]; s++)
    for (int64_t m = first[1]; m < first[1] + count[1]; m++) {
      size_t row = row_of(job, m, s);
      for (int64_t f = 0; f < count[0]; f += 64) {
        int64_t n = vxm_min(64, count[0] - f);
        store_bits(job, out->words + row * out->row_words, first[0] + f, n,
                   at_least_one(job, row, first[0] + f, n, number));
      }
    }
}

/** The whole of a row's winding number: that of the closed chain at a voxel and `value`. */
static double whole_number(const fill_job *job, size_t row, int64_t fast, double value) {
  const vxm_chain_winding *closed = &job->mesh->closed;
  if (closed->counted[row])
    return (double)vxm_chain_winding_at(closed, row, fast) + value;
  const uint64_t *word = closed->window.words + row * closed->window.row_words + fast / 64;
  return (double)(__atomic_load_n(word, __ATOMIC_RELAXED) >> (fast % 64) & 1) + value;
}

/** The bits of a row of a brick, the first of them at voxel `from` of it, `step` apart. */
static uint64_t row_bits(uint64_t mask, int64_t from, int64_t step, int64_t count) {
  if (step == 1)
    return mask >> from & vxm_low_bits((unsigned)count);
  uint64_t bits = 0;
  for (int64_t i = 0; i < count; i++)
    bits |= (mask >> (from + i * step) & 1) << i;
  return bits;
}

/** What is still in doubt gets its number by doubles. */
static void resolve(const fill_job *job, const int64_t origin[3], uint64_t doubtful,
                    vxm_winding_brick *brick) {
  double number[VXM_BRICK];
  uint64_t close = 0;
  for (uint64_t left = doubtful; left && !job->confidence; left &= left - 1) {
    double half = (double)brick->value[__builtin_ctzll(left)] - 0.5;
    close |= fabs(half - rint(half)) < (double)strict_doubt ? left & -left : 0;
  }
  vxm_winding_exact(number, job->kernels, &job->mesh->tree, origin, brick->doubtful, doubtful, close);
  for (uint64_t left = doubtful; left; left &= left - 1) {
    int v = __builtin_ctzll(left);
    double w = number[v];
    uint64_t bit = left & -left;
    brick->value[v] = (float)w;
    brick->above[0] = (brick->above[0] & ~bit) | (w > tie - 0.5 ? bit : 0);
    brick->above[1] = (brick->above[1] & ~bit) | (w > tie + 0.5 ? bit : 0);
  }
}

/** Voxels of a brick are this far from each other in its masks, along x, y and z. */
static const int64_t place[3] = {1, 4, 16};

/** A row of a brick, as far as it lies in the window. */
typedef struct brick_row {
  size_t row;     /**< of the window */
  int64_t start;  /**< the voxel of the brick that is its first one */
  uint64_t asked; /**< which of its voxels are asked about */
} brick_row;

/** The rows of a brick in which something is asked about. */
typedef struct brick_rows {
  brick_row row[VXM_BRICK_SIDE * VXM_BRICK_SIDE];
  int count;
  int64_t first;  /**< voxel of all of them */
  int64_t step;   /**< of their voxels in masks of the brick */
  uint64_t asked; /**< about which voxels of the brick */
} brick_rows;

/** The bits of a row, as far from each other as in a mask of a brick. */
static inline uint64_t apart(uint64_t bits, int64_t step) {
  if (step == 1)
    return bits;
  uint64_t out = 0;
  for (int64_t i = 0; i < VXM_BRICK_SIDE; i++)
    out |= (bits >> i & 1) << (i * step);
  return out;
}

static void list_rows(brick_rows *out, const fill_job *job, const int64_t origin[3]) {
  const vxm_window *window = job->window;
  const vxm_layout *layout = &window->layout;
  int64_t first[3], count[3];
  clip(job, origin, VXM_BRICK_SIDE, first, count);
  const int64_t step = place[layout->fast];
  const uint64_t all = vxm_low_bits((unsigned)count[0]);
  out->count = 0;
  out->asked = 0;
  out->first = first[0];
  out->step = step;
  for (int64_t s = first[2]; s < first[2] + count[2]; s++) {
    size_t word = (size_t)(s - window->begin) * window->slice_words + (size_t)first[1] * window->row_words +
                  (size_t)first[0] / 64;
    size_t row = row_of(job, first[1], s);
    int64_t start = (s - origin[layout->slow]) * place[layout->slow] +
                    (first[1] - origin[layout->middle]) * place[layout->middle] +
                    (first[0] - origin[layout->fast]) * step;
    for (int64_t m = 0; m < count[1]; m++, word += window->row_words, start += place[layout->middle]) {
      uint64_t asked = job->asked ? job->asked[word] >> (first[0] % 64) & all : all;
      if (!asked)
        continue;
      out->asked |= apart(asked, step) << start;
      out->row[out->count++] = (brick_row){row + (size_t)m, start, asked};
    }
  }
}

/** The word of a row in which the voxels of a brick are. */
static uint64_t *word_of(const fill_job *job, const brick_rows *rows, const brick_row *row) {
  return decided(job)->words + row->row * decided(job)->row_words + rows->first / 64;
}

/** A row by numbers: where that of the closed chain must be counted, or confidence is asked. */
static void settle_row(const fill_job *job, const vxm_winding_brick *brick, const brick_rows *rows,
                       const brick_row *row) {
  const vxm_window *out = decided(job);
  uint64_t bits = 0;
  for (int64_t i = 0; i < VXM_BRICK_SIDE && rows->first + i < out->fast_dim; i++) {
    int64_t fast = rows->first + i;
    double w = whole_number(job, row->row, fast, (double)brick->value[row->start + i * rows->step]);
    bits |= (uint64_t)(w > 0.5 + tie) << i;
    if (job->confidence && row->asked >> i & 1) {
      double sure = fabs(2 * w - 1);
      job->confidence[(size_t)out->fast_dim * (row->row + (size_t)(out->begin * out->middle_dim)) +
                      (size_t)fast] = (uint8_t)(sure < 1 ? 255 * sure : 255);
    }
  }
  store_word(job, word_of(job, rows, row), bits << (rows->first % 64), row->asked << (rows->first % 64));
}

/** Rows of which the closed chain has a number of 0 or 1 all over, which their bits tell. */
static void settle_rows(const fill_job *job, const vxm_winding_brick *brick, const brick_rows *rows) {
  const int shift = (int)(rows->first % 64);
  uint64_t chain = 0;
  for (int r = 0; r < rows->count; r++) {
    uint64_t word = __atomic_load_n(word_of(job, rows, &rows->row[r]), __ATOMIC_RELAXED);
    chain |= apart(word >> shift & 15, rows->step) << rows->row[r].start;
  }
  uint64_t change = ((chain & ~brick->above[0]) | (~chain & brick->above[1])) & rows->asked;
  for (int r = 0; r < rows->count && change; r++) {
    uint64_t bits = row_bits(change, rows->row[r].start, rows->step, VXM_BRICK_SIDE) & rows->row[r].asked;
    flip(job, word_of(job, rows, &rows->row[r]), bits << shift);
  }
}

static bool has_counted(const fill_job *job, const brick_rows *rows) {
  uint32_t any = 0;
  for (int r = 0; r < rows->count; r++)
    any |= job->mesh->closed.counted[rows->row[r].row];
  return any != 0;
}

static void settle_brick(const vxm_winding_walk *walk, const int64_t origin[3],
                         const vxm_winding_brick *brick) {
  const fill_job *job = job_of(walk);
  brick_rows rows;
  if (!brick->doubtful && !~brick->above[0] && !brick->above[1] && !job->confidence)
    return; /* as the closed chain says */
  list_rows(&rows, job, origin);
  uint64_t doubtful = brick->doubtful;
  if (!job->confidence)
    doubtful &= rows.asked;
  vxm_winding_brick resolved;
  if (doubtful && !walk->strict) {
    *vxm_brick_mask_at(&job->mesh->doubted, origin, 0) = 1; /* the bits stay those of the closed chain */
    return;
  }
  if (doubtful) {
    resolved = *brick;
    resolve(job, origin, doubtful, &resolved);
    brick = &resolved;
  }
  if (!job->confidence && !has_counted(job, &rows)) {
    settle_rows(job, brick, &rows);
    return;
  }
  for (int r = 0; r < rows.count; r++)
    settle_row(job, brick, &rows, &rows.row[r]);
}

/* ---- The walk ---- */

static void hand_on(const vxm_winding_walk *walk, vxm_winding_scratch *scratch, const int64_t origin[3],
                    const float samples[VXM_BRICK], size_t list, size_t count) {
  fill_job *job = (fill_job *)job_of(walk); /* the walk is its own, and but one thread walks so far */
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
  if (scratch->status != VXM_OK || vxm_task_progress_stopped(&job->watch, worker))
    return;
  scratch->count = 0;
  for (size_t i = 0; i < task->count; i++)
    vxm_winding_scratch_add(scratch, job->lists.nodes[task->list + i]);
  if (scratch->status == VXM_OK)
    job->kernels->descend(&job->walk, scratch, task->origin, job->walk.task_level, task->samples, 0,
                          task->count);
  vxm_task_progress_step(&job->watch);
}

/** Walks down to the cells that are tasks, then through these in all threads. */
static vxm_status walk(fill_job *job, int top, vxm_error *error) {
  static const int64_t origin[3] = {0, 0, 0};
  static const float nothing[VXM_BRICK] = {0};
  enum { LEVELS_BEFORE = 3 }; /* up to 512 tasks */
  vxm_context *context = job->mesh->context;
  size_t workers = (size_t)vxm_context_threads(context);
  vxm_winding_scratch *first = &job->scratch[0];
  job->task_count = 0;
  job->lists.count = 0;
  job->walk.task_level = top > LEVELS_BEFORE ? top - LEVELS_BEFORE : 0;
  job->walk.hand_on = hand_on;
  first->count = 0;
  for (size_t r = 0; r < job->mesh->tree.root_count; r++)
    vxm_winding_scratch_add(first, job->mesh->tree.roots[r]);
  if (first->status == VXM_OK && wants(&job->walk, origin, top))
    job->kernels->descend(&job->walk, first, origin, top, nothing, 0, job->mesh->tree.root_count);
  job->walk.hand_on = NULL;
  if (first->status != VXM_OK) {
    vxm_error_pass(error, &first->error);
    return first->status;
  }
  vxm_task_progress_start(&job->watch, context, "computing winding numbers", job->task_count, error);
  vxm_parallel(context, job->task_count, walk_task, job);
  for (size_t w = 0; w < workers; w++)
    if (job->scratch[w].status != VXM_OK) {
      vxm_error_pass(error, &job->scratch[w].error);
      return job->scratch[w].status;
    }
  return vxm_task_progress_end(&job->watch);
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
  const vxm_window *window = job->window;
  const vxm_brick_mask *mask = &job->mesh->asked;
  const ptrdiff_t step[3] = {1, (ptrdiff_t)mask->count[0][0],
                             (ptrdiff_t)(mask->count[0][0] * mask->count[0][1])};
  int64_t base = window->begin / VXM_BRICK_SIDE * VXM_BRICK_SIDE + VXM_BRICK_SIDE * (int64_t)layer, at[3];
  int64_t s_begin = vxm_max(base, window->begin), s_end = vxm_min(base + VXM_BRICK_SIDE, window->end);
  at[window->layout.slow] = s_begin;
  for (int64_t m = 0; m < window->middle_dim && s_begin < s_end; m += VXM_BRICK_SIDE) {
    const uint64_t *words =
        job->asked + (size_t)(s_begin - window->begin) * window->slice_words + (size_t)m * window->row_words;
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
  const vxm_window *window = job->window, *from = decided(job);
  uint64_t *to = window->words + slice * window->slice_words, added = 0;
  const uint64_t *bits = from->words + slice * from->slice_words,
                 *asked = job->asked ? job->asked + slice * window->slice_words : NULL;
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
  vxm_winding_mesh *mesh = job->mesh;
  vxm_context *context = mesh->context;
  size_t depth = (size_t)(job->window->end - job->window->begin);
  vxm_status status = vxm_brick_mask_begin(&mesh->doubted, job->begin, job->end, job->top + 1, error);
  if (status == VXM_OK && job->asked) {
    status = vxm_brick_mask_begin(&mesh->asked, job->begin, job->end, job->top + 1, error);
    if (status == VXM_OK)
      status = vxm_parallel_asked(context, (depth + 6) / 4, mark_asked_slice, job, error);
    job->is_asked = true;
    if (status != VXM_OK || !vxm_brick_mask_raise(&mesh->asked))
      return status;
  }
  if (status == VXM_OK)
    status = walk(job, job->top, error);
  if (status != VXM_OK || !vxm_brick_mask_raise(&mesh->doubted))
    return status;
  job->walk.strict = true;
  job->walk.doubt = strict_doubt;
  return walk(job, job->top, error);
}

vxm_status vxm_winding_fill(vxm_winding_mesh *mesh, const vxm_window *window, const uint64_t *asked,
                            uint8_t *confidence, vxm_workspace *workspace, bool *added, vxm_error *error) {
  if (window->begin >= window->end)
    return VXM_OK;
  vxm_status status = vxm_chain_winding_fill(&mesh->closed, workspace, mesh->placed, window, !asked, error);
  if (status != VXM_OK)
    return status;
  fill_job job = {.walk = {.tree = &mesh->tree,
                           .levels = vxm_winding_levels(),
                           .doubt = doubt,
                           .whole = confidence != NULL,
                           .wants = wants,
                           .settle_cell = settle_cell,
                           .settle_brick = settle_brick},
                  .mesh = mesh,
                  .window = window,
                  .asked = asked,
                  .confidence = confidence,
                  .is_alone = vxm_context_threads(mesh->context) == 1,
                  .kernels = vxm_winding_kernels_get()};
  job.end[window->layout.fast] = window->fast_dim;
  job.end[window->layout.middle] = window->middle_dim;
  job.begin[window->layout.slow] = window->begin;
  job.end[window->layout.slow] = window->end;
  int64_t longest = vxm_max(vxm_max(window->fast_dim, window->middle_dim), window->slow_dim);
  while (INT64_C(4) << job.top < longest)
    job.top++;
  vxm_context *context = mesh->context;
  size_t workers = (size_t)vxm_context_threads(context);
  job.lists = (vxm_winding_scratch){.context = context, .error = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  job.scratch = vxm_calloc(context, workers, sizeof *job.scratch, &local);
  if (!job.scratch) {
    vxm_error_pass(error, &local);
    return local.code;
  }
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
  if (decided(&job)->words == window->words) {
    size_t words = window->slice_words * (size_t)(window->end - window->begin);
    for (size_t w = 0; w < words && !*added; w++)
      *added = window->words[w] != 0;
    return VXM_OK;
  }
  merge_state state = {.job = &job};
  atomic_init(&state.added, false);
  vxm_parallel(context, (size_t)(window->end - window->begin), merge_slice, &state);
  *added |= atomic_load(&state.added);
  return VXM_OK;
}
