/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_fill.h"
#include "base/task_progress.h"
#include "base/threads.h"

#include <math.h>

typedef struct settle_job {
  const vxm_window *window;
  const uint64_t *asked;
  const vxm_winding *winding;
  uint8_t *confidence;
  size_t row_count;    /**< bricks along the middle axis */
  int64_t first_layer; /**< brick along the slow axis in which the window begins */
  size_t place[3];     /**< of a voxel in a brick: what a step along each axis of the window adds */
  atomic_int_fast64_t added;
  vxm_task_progress watch;
} settle_job;

/** The voxels of a brick that are asked about, as bits 16 slow + 4 middle + fast. f is a multiple of 4. */
static uint64_t asked_in_brick(const settle_job *job, int64_t f, int64_t m, int64_t s) {
  const vxm_window *window = job->window;
  uint64_t bits = 0;
  for (int row = 0; row < 16; row++) {
    int64_t middle = m + row % 4, slow = s + row / 4;
    if (middle >= window->middle_dim || slow < window->begin || slow >= window->end)
      continue;
    uint64_t four = 15;
    if (job->asked)
      four = job->asked[(size_t)(slow - window->begin) * window->slice_words +
                        (size_t)middle * window->row_words + (size_t)f / 64] >>
                 (f % 64) &
             15;
    else if (window->fast_dim - f < 4)
      four = vxm_low_bits((unsigned)(window->fast_dim - f));
    bits |= four << (4 * row);
  }
  return bits;
}

/** f, m and s are the first voxel of a brick; returns the number of voxels newly set. */
static int64_t decide_brick(const settle_job *job, int64_t f, int64_t m, int64_t s, uint64_t bits) {
  const vxm_window *window = job->window;
  int64_t at[3], added = 0;
  at[window->layout.fast] = f, at[window->layout.middle] = m, at[window->layout.slow] = s;
  float value[VXM_BRICK];
  vxm_winding_brick(job->winding, at[0], at[1], at[2], value);
  for (; bits; bits &= bits - 1) {
    int v = __builtin_ctzll(bits);
    int64_t fast = f + v % 4, middle = m + v / 4 % 4, slow = s + v / 16;
    float w = value[(size_t)(v % 4) * job->place[0] + (size_t)(v / 4 % 4) * job->place[1] +
                    (size_t)(v / 16) * job->place[2]];
    uint64_t *word = vxm_window_row(window, middle, slow) + fast / 64, bit = UINT64_C(1) << (fast % 64);
    if (w > 0.5F && !(*word & bit)) {
      *word |= bit;
      added++;
    }
    if (job->confidence) {
      float sure = fabsf(2.0F * w - 1.0F);
      job->confidence[(slow * window->middle_dim + middle) * window->fast_dim + fast] =
          (uint8_t)(sure < 1.0F ? 255.0F * sure : 255.0F);
    }
  }
  return added;
}

/** A row of bricks along the fast axis: its words belong to this task alone. */
static void decide_row(size_t task, int worker, void *payload) {
  settle_job *job = payload;
  if (vxm_task_progress_stopped(&job->watch, worker))
    return;
  int64_t s = 4 * (job->first_layer + (int64_t)(task / job->row_count)),
          m = 4 * (int64_t)(task % job->row_count);
  int64_t added = 0;
  for (int64_t f = 0; f < job->window->fast_dim; f += 4) {
    uint64_t bits = asked_in_brick(job, f, m, s);
    if (bits)
      added += decide_brick(job, f, m, s, bits);
  }
  atomic_fetch_add_explicit(&job->added, added, memory_order_relaxed);
  vxm_task_progress_step(&job->watch);
}

vxm_status vxm_winding_fill(const vxm_window *window, const uint64_t *asked, const vxm_winding *winding,
                            vxm_context *context, uint8_t *confidence, int64_t *added, vxm_error *error) {
  static const size_t step[3] = {1, 4, 16};
  settle_job job = {.window = window, .asked = asked, .winding = winding, .confidence = confidence};
  job.place[0] = step[window->layout.fast];
  job.place[1] = step[window->layout.middle];
  job.place[2] = step[window->layout.slow];
  job.first_layer = window->begin / 4;
  job.row_count = (size_t)(window->middle_dim + 3) / 4;
  size_t layers = (size_t)((window->end + 3) / 4 - job.first_layer);
  atomic_init(&job.added, 0);
  vxm_task_progress_start(&job.watch, context, "computing winding numbers", layers * job.row_count, error);
  vxm_parallel(context, layers * job.row_count, decide_row, &job);
  *added += atomic_load(&job.added);
  return vxm_task_progress_end(&job.watch);
}
