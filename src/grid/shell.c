/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/shell.h"
#include "base/threads.h"

#include <string.h>

/** Words of a row that are worked on at once, and of all rows of a task. */
enum { BLOCK = 128, TASK_WORDS = 1 << 14 };

typedef struct shell_job {
  const vxm_window *out, *solid;
  vxm_adjacency adjacency;
  int64_t rows; /**< of a task */
  size_t tasks_per_slice;
} shell_job;

/** The rows around a voxel's own: in `wide` ones the voxels at both sides of it are adjacent too. */
typedef struct rows {
  const uint64_t *wide[9], *narrow[4];
  int wide_count, narrow_count;
} rows;

static rows rows_around(const vxm_window *solid, int64_t middle, int64_t slow, vxm_adjacency adjacency) {
  rows r = {.wide_count = 0};
  for (int ds = -1; ds <= 1; ds++)
    for (int dm = -1; dm <= 1; dm++) {
      const uint64_t *row = vxm_window_row(solid, middle + dm, slow + ds);
      int steps = (ds != 0) + (dm != 0), free_steps = adjacency == VXM_ADJACENT_6    ? 1
                                                      : adjacency == VXM_ADJACENT_18 ? 2
                                                                                     : 3;
      if (steps < free_steps)
        r.wide[r.wide_count++] = row;
      else if (steps == free_steps)
        r.narrow[r.narrow_count++] = row;
    }
  return r;
}

/** The words `begin` to `end` - 1 of a row of the shell. */
static void fill_block(uint64_t *out, const uint64_t *own, const rows *r, size_t begin, size_t end,
                       size_t row_words) {
  /* The AND of the wide rows, with the word before and the one behind; beyond the row all is empty. */
  uint64_t all[BLOCK + 2];
  size_t first = begin - (begin > 0), last = end + (end < row_words);
  uint64_t *at = all + 1 - (begin > 0);
  all[0] = all[end - begin + 1] = 0;
  memcpy(at, r->wide[0] + first, (last - first) * sizeof *at);
  for (int n = 1; n < r->wide_count; n++)
    for (size_t w = first; w < last; w++)
      at[w - first] &= r->wide[n][w];
  for (size_t w = begin; w < end; w++) {
    const uint64_t *word = all + 1 + (w - begin);
    out[w] = word[0] & (word[0] << 1 | word[-1] >> 63) & (word[0] >> 1 | word[1] << 63);
  }
  for (int n = 0; n < r->narrow_count; n++)
    for (size_t w = begin; w < end; w++)
      out[w] &= r->narrow[n][w];
  for (size_t w = begin; w < end; w++)
    out[w] = own[w] & ~out[w];
}

static void fill_row(const shell_job *job, int64_t middle, int64_t slow) {
  const vxm_window *solid = job->solid;
  const uint64_t *own = vxm_window_row(solid, middle, slow);
  uint64_t *out = vxm_window_row(job->out, middle, slow);
  bool is_border = middle == 0 || middle + 1 == solid->middle_dim || slow == 0 || slow + 1 == solid->slow_dim;
  if (is_border) {
    memcpy(out, own, solid->row_words * sizeof *out);
    return;
  }
  rows r = rows_around(solid, middle, slow, job->adjacency);
  for (size_t w = 0; w < solid->row_words; w += BLOCK)
    fill_block(out, own, &r, w, w + BLOCK < solid->row_words ? w + BLOCK : solid->row_words,
               solid->row_words);
}

static void fill_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const shell_job *job = payload;
  int64_t slow = job->out->begin + (int64_t)(task / job->tasks_per_slice),
          begin = (int64_t)(task % job->tasks_per_slice) * job->rows,
          end = vxm_min(begin + job->rows, job->out->middle_dim);
  for (int64_t middle = begin; middle < end; middle++)
    fill_row(job, middle, slow);
}

void vxm_shell_fill(const vxm_window *out, const vxm_window *solid, vxm_adjacency adjacency,
                    vxm_context *context) {
  int64_t some = vxm_max(1, TASK_WORDS / (int64_t)out->row_words);
  shell_job job = {out, solid, adjacency, some, (size_t)((out->middle_dim + some - 1) / some)};
  vxm_parallel(context, (size_t)(out->end - out->begin) * job.tasks_per_slice, fill_rows, &job);
}
