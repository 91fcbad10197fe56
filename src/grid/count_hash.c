/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/count_hash.h"
#include "base/hash.h"
#include "base/threads.h"

/** A range of rows of a window, counted through its slices, and what their places mean. */
typedef struct rows {
  const vxm_window *window;
  const uint64_t *before;
  int64_t nx;
  uint64_t step[3]; /**< of the voxel's index along x, y and z */
} rows;

static rows rows_of(const vxm_window *window, const uint64_t *before) {
  int64_t dims[3] = {0};
  dims[window->layout.fast] = window->fast_dim;
  dims[window->layout.middle] = window->middle_dim;
  dims[window->layout.slow] = window->slow_dim;
  /* Below 2^60, as each is at most VXM_DIM_MAX. */
  return (rows){window, before, dims[0], {1, (uint64_t)dims[0], (uint64_t)dims[0] * (uint64_t)dims[1]}};
}

/** What the bits of a row are: bit b of the row has the index `index` + b * stride, and `left` - b * fall
 * voxels from it to the end of its line along x. */
typedef struct line {
  uint64_t index, stride;
  int64_t left, fall;
} line;

/** Adds the steps of word `w` of its row. */
static inline void add_steps(vxm_count_hash *sum, uint64_t steps, uint64_t word, size_t w, line at) {
  for (; steps; steps &= steps - 1) {
    unsigned b = (unsigned)__builtin_ctzll(steps);
    size_t bit = w * 64 + b;
    int64_t down = (int64_t)(word >> b & 1) - 1, voxels = at.left - (int64_t)bit * at.fall;
    sum->count += (voxels ^ down) - down;
    sum->hash += vxm_hash_word(0, at.index + bit * at.stride);
  }
}

/** A row along x; `tail` has the valid bits of its last word. */
static inline void sum_along(vxm_count_hash *sum, const uint64_t *row, size_t words, uint64_t tail, line at) {
  uint64_t last = 0; /* the bit before, in all places */
  for (size_t w = 0; w < words;) {
    size_t end = w + VXM_LINE_WORDS <= words ? w + VXM_LINE_WORDS : words;
    if (w + VXM_LINE_WORDS <= words && vxm_line_is(row + w, last)) {
      w = end;
      continue;
    }
    for (; w < end; w++) {
      uint64_t word = row[w];
      if (word == last)
        continue;
      uint64_t steps = word ^ (word << 1 | last >> 63);
      add_steps(sum, w + 1 == words ? steps & tail : steps, word, w, at);
      last = UINT64_C(0) - (word >> 63);
    }
  }
}

/** A row across x, against the one at i - 1; NULL stands for clear voxels. */
static inline void sum_across(vxm_count_hash *sum, const uint64_t *row, const uint64_t *previous,
                              size_t words, line at) {
  static const uint64_t clear[VXM_LINE_WORDS] = {0};
  for (size_t w = 0; w < words; w += VXM_LINE_WORDS) {
    const uint64_t *from = previous ? previous + w : clear;
    size_t count = words - w < VXM_LINE_WORDS ? words - w : VXM_LINE_WORDS;
    if (count == VXM_LINE_WORDS && vxm_lines_equal(row + w, from))
      continue;
    for (size_t i = 0; i < count; i++)
      add_steps(sum, row[w + i] ^ from[i], row[w + i], w + i, at);
  }
}

/** Rows begin..end-1; row n is row n % middle_dim of slice n / middle_dim of the window. */
static vxm_count_hash sum_rows(const rows *r, size_t begin, size_t end) {
  const vxm_window *window = r->window;
  const vxm_layout layout = window->layout;
  uint64_t tail = vxm_window_tail_mask(window);
  vxm_count_hash sum = {0, 0};
  int64_t middle = (int64_t)(begin % (size_t)window->middle_dim);
  int64_t slow = window->begin + (int64_t)(begin / (size_t)window->middle_dim);
  for (size_t n = begin; n < end; n++) {
    const uint64_t *row = vxm_window_row(window, middle, slow);
    line at = {.index = (uint64_t)middle * r->step[layout.middle] + (uint64_t)slow * r->step[layout.slow],
               .stride = r->step[layout.fast],
               .left = r->nx,
               .fall = layout.fast == 0};
    if (layout.fast == 0)
      sum_along(&sum, row, window->row_words, tail, at);
    else {
      const uint64_t *previous = NULL;
      if (layout.middle == 0)
        previous = middle > 0 ? row - window->row_words : NULL;
      else if (slow > window->begin)
        previous = row - window->slice_words;
      else if (slow > 0)
        previous = r->before + (size_t)middle * window->row_words;
      at.left -= layout.middle == 0 ? middle : slow;
      sum_across(&sum, row, previous, window->row_words, at);
    }
    if (++middle == window->middle_dim) {
      middle = 0;
      slow++;
    }
  }
  return sum;
}

vxm_count_hash vxm_count_hash_start(const vxm_space *space) {
  vxm_count_hash sum = {0, 0};
  for (int a = 0; a < 3; a++)
    sum.hash = vxm_hash_word(sum.hash, (uint64_t)space->dims[a]);
  return sum;
}

enum { TASKS = 256, TASK_WORDS = 1 << 13 };

typedef struct sum_job {
  rows r;
  size_t row_count, tasks;
  vxm_count_hash parts[TASKS];
} sum_job;

static void sum_task(size_t task, int worker, void *payload) {
  (void)worker;
  sum_job *job = payload;
  job->parts[task] = sum_rows(&job->r, vxm_slice_begin(job->row_count, job->tasks, task),
                              vxm_slice_begin(job->row_count, job->tasks, task + 1));
}

void vxm_count_hash_add(vxm_count_hash *sum, vxm_context *context, const vxm_window *window,
                        const uint64_t *before) {
  sum_job job = {.r = rows_of(window, before)};
  job.row_count = (size_t)(window->end - window->begin) * (size_t)window->middle_dim;
  /* At least so many words each that a task is worth its start. */
  size_t worth = job.row_count * window->row_words / TASK_WORDS + 1;
  job.tasks = worth < TASKS ? worth : TASKS;
  vxm_parallel(context, job.tasks, sum_task, &job);
  for (size_t t = 0; t < job.tasks; t++)
    vxm_count_hash_join(sum, job.parts[t]);
}
