/* SPDX-License-Identifier: BSD-3-Clause */
/** Parallel loops over the worker threads of a context. */
#ifndef VXM_BASE_THREADS_H
#define VXM_BASE_THREADS_H

#include "base/context.h"

#include <stdatomic.h>

/** One task of a loop. `worker` is below vxm_context_threads and tells apart tasks that may run at the same
 * time. */
typedef void (*vxm_task_fn)(size_t task, int worker, void *payload);

/**
 * Runs function(0..count-1), each once, on the context's threads, and returns when all are done.
 * Tasks are taken in order but may overlap, so each must own what it writes. A loop inside a loop, or beside
 * another caller's loop in the same context, runs on the calling thread alone.
 */
void vxm_parallel(vxm_context *context, size_t count, vxm_task_fn function, void *payload);

/**
 * As vxm_parallel, but asks between tasks whether to go on (vxm_check_cancelled).
 *
 * @return VXM_OK; VXM_ERROR_CANCELLED, then some tasks were left out
 */
vxm_status vxm_parallel_cancellable(vxm_context *context, size_t count, vxm_task_fn function, void *payload,
                                    vxm_error *error);

/** For tasks that have asked by themselves: VXM_ERROR_CANCELLED, with what was told last in the message. */
vxm_status vxm_fail_cancelled(vxm_error *error);

/** Tells the other threads of the loop that this thread works on, as its caller, to stop. */
void vxm_loop_stop(void);
/** Whether the loop that this thread works on is to stop. */
bool vxm_loop_stopped(void);

/** Whether this is one of the threads that vxm_parallel starts, rather than one that called it. */
bool vxm_is_worker(void);

/** For a thread of its own that works for a call made by another: it reports nothing, and hears through
 * `stop`, which outlives it, whether to stop. */
void vxm_worker_begin(const atomic_bool *stop);

/** First element of slice `index` of `total` elements cut into `slices` nearly equal slices. */
static inline size_t vxm_slice_begin(size_t total, size_t slices, size_t index) {
  size_t base = total / slices, rest = total % slices;
  return base * index + (index < rest ? index : rest);
}

#endif
