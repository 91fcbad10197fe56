/* SPDX-License-Identifier: BSD-3-Clause */
/** Parallel loops over the worker threads of a context. */
#ifndef VXM_BASE_THREADS_H
#define VXM_BASE_THREADS_H

#include "base/context.h"

/** One task of a loop. `worker` is below vxm_context_threads and tells apart tasks that may run at the same
 * time. */
typedef void (*vxm_task_fn)(size_t task, int worker, void *payload);

/**
 * Runs function(0..count-1), each once, on the context's threads, and returns when all are done.
 * Tasks are taken in order but may overlap, so each must own what it writes. A loop inside a loop, or beside
 * another caller's loop in the same context, runs on the calling thread alone.
 */
void vxm_parallel(vxm_context *context, size_t count, vxm_task_fn function, void *payload);

/** Whether this is one of the threads that vxm_parallel starts, rather than one that called it. */
bool vxm_is_worker(void);

/** First element of slice `index` of `total` elements cut into `slices` nearly equal slices. */
static inline size_t vxm_slice_begin(size_t total, size_t slices, size_t index) {
  size_t base = total / slices, rest = total % slices;
  return base * index + (index < rest ? index : rest);
}

#endif
