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

static inline void vxm_task_progress_start(vxm_task_progress *watch, vxm_context *in, const char *phase,
                                           size_t total, vxm_error *error) {
  watch->context = in;
  watch->phase = phase;
  watch->total = total > 0 ? total : 1;
  watch->status = VXM_OK;
  watch->error = error;
  atomic_init(&watch->done, 0);
  atomic_init(&watch->stop, false);
}

/** To be asked before each step: whether to leave it out, because the work has been cancelled. */
static inline bool vxm_task_progress_stopped(vxm_task_progress *watch, int worker) {
  if (worker == 0 && watch->status == VXM_OK) {
    size_t done = atomic_load_explicit(&watch->done, memory_order_relaxed);
    watch->status =
        vxm_progress(watch->context, watch->phase, (double)done / (double)watch->total, watch->error);
    if (watch->status != VXM_OK)
      atomic_store_explicit(&watch->stop, true, memory_order_relaxed);
  }
  return atomic_load_explicit(&watch->stop, memory_order_relaxed);
}

static inline void vxm_task_progress_step(vxm_task_progress *watch) {
  atomic_fetch_add_explicit(&watch->done, 1, memory_order_relaxed);
}

/** After the work: asks once more, as other threads may have taken the last steps, so that no wish to stop is
 * missed. */
static inline vxm_status vxm_task_progress_end(vxm_task_progress *watch) {
  return watch->status == VXM_OK ? vxm_progress(watch->context, watch->phase, 1.0, watch->error)
                                 : watch->status;
}

#endif
