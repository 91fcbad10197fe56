/* SPDX-License-Identifier: BSD-3-Clause */
/** Progress and cancelling of work that is done by several threads. */
#ifndef VXM_BASE_TASK_PROGRESS_H
#define VXM_BASE_TASK_PROGRESS_H

#include "base/context.h"

#include <stdatomic.h>

/** Worker 0 is the calling thread, the only one that may report progress; the others look whether to stop. */
typedef struct vxm_task_progress {
  vxm_context *context;
  const char *phase;
  size_t total; /**< steps of all the work */
  atomic_size_t done;
  atomic_bool stop;
  vxm_status status; /**< written by the calling thread only */
  vxm_error *error;
} vxm_task_progress;

static inline void vxm_task_progress_start(vxm_task_progress *progress, vxm_context *in, const char *phase,
                                           size_t total, vxm_error *error) {
  progress->context = in;
  progress->phase = phase;
  progress->total = total > 0 ? total : 1;
  progress->status = VXM_OK;
  progress->error = error;
  atomic_init(&progress->done, 0);
  atomic_init(&progress->stop, false);
}

/** To be asked before each step: whether to leave it out, because the work has been cancelled. */
static inline bool vxm_task_progress_stopped(vxm_task_progress *progress, int worker) {
  if (worker == 0 && progress->status == VXM_OK) {
    size_t done = atomic_load_explicit(&progress->done, memory_order_relaxed);
    progress->status = vxm_progress(progress->context, progress->phase,
                                    (double)done / (double)progress->total, progress->error);
    if (progress->status != VXM_OK)
      atomic_store_explicit(&progress->stop, true, memory_order_relaxed);
  }
  return atomic_load_explicit(&progress->stop, memory_order_relaxed);
}

static inline void vxm_task_progress_step(vxm_task_progress *progress) {
  atomic_fetch_add_explicit(&progress->done, 1, memory_order_relaxed);
}

/** After the work: asks once more, as other threads may have taken the last steps, so that no wish to stop is
 * missed. */
static inline vxm_status vxm_task_progress_end(vxm_task_progress *progress) {
  return progress->status == VXM_OK ? vxm_progress(progress->context, progress->phase, 1.0, progress->error)
                                    : progress->status;
}

#endif
