/* SPDX-License-Identifier: BSD-3-Clause */
/** Contexts inside the library: reference counts, memory under a limit, progress. */
#ifndef VXM_BASE_CONTEXT_H
#define VXM_BASE_CONTEXT_H

#include "base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/** NULL makes a new default context, otherwise adds a reference. Every object holds one. */
vxm_status vxm_context_acquire(vxm_context **out, vxm_context *context, vxm_error *error);
void vxm_context_release(vxm_context *context);
/**
 * A context whose memory counts as that of its parent, to which it holds a reference, and which keeps what is
 * freed for the next that needs it: for work that is done again and again. What is kept counts as in use, but
 * is given back before an allocation would fail for it.
 *
 * @param alone whether it has one thread and no progress, for a task that works while others like it run
 * beside it; else it works with its parent's
 */
vxm_status vxm_context_child(vxm_context **out, vxm_context *parent, bool alone, vxm_error *error);

/**
 * Allocates count * size bytes, aligned to 64 bytes, counted against the limit.
 * Returns NULL and fills `error` (VXM_ERROR_MEMORY or VXM_ERROR_MEMORY_LIMIT) when it cannot; the product is
 * checked. A count of 0 gives a valid pointer. Thread-safe.
 */
void *vxm_alloc(vxm_context *context, size_t count, size_t size, vxm_error *error);
/** As vxm_alloc, zeroed (cheap for large blocks: the system hands out zero pages). */
void *vxm_calloc(vxm_context *context, size_t count, size_t size, vxm_error *error);
/**
 * vxm_alloc and vxm_calloc for a function that returns a status: where they fail, *status becomes the code of
 * the message, whether or not one is asked for; else it stays as it is.
 */
void *vxm_try_alloc(vxm_context *context, size_t count, size_t size, vxm_status *status, vxm_error *error);
void *vxm_try_calloc(vxm_context *context, size_t count, size_t size, vxm_status *status, vxm_error *error);
/** Grows or shrinks a block, keeping its content; on failure the block stays valid and NULL is returned. */
void *vxm_realloc(vxm_context *context, void *block, size_t count, size_t size, vxm_error *error);
/** Frees a block of this context; NULL is allowed. */
void vxm_free(vxm_context *context, void *block);

/** Bytes that could still be allocated; SIZE_MAX without a limit. */
size_t vxm_memory_left(const vxm_context *context);
/**
 * Checks an estimate before work starts: VXM_OK, or VXM_ERROR_MEMORY_LIMIT with a message that names `what`
 * and both figures.
 */
vxm_status vxm_memory_check(const vxm_context *context, uint64_t bytes, const char *what, vxm_error *error);

/**
 * Counts bytes that a library takes on behalf of this context, before it does.
 *
 * @return VXM_OK; VXM_ERROR_MEMORY_LIMIT, then they are not counted
 */
vxm_status vxm_memory_take(vxm_context *context, size_t bytes, vxm_error *error);
/** Counts them no longer. */
void vxm_memory_give(vxm_context *context, size_t bytes);

/**
 * Makes room for at least `needed` elements in a growing array, which grows by a half at least, and updates
 * *capacity.
 * `*array` is a block of this context or NULL.
 */
vxm_status vxm_grow(vxm_context *context, void **array, size_t *capacity, size_t needed, size_t size,
                    vxm_error *error);

/** The same where the content is needed no more: exactly so many elements, where there were fewer. */
vxm_status vxm_renew(vxm_context *context, void **array, size_t *capacity, size_t needed, size_t size,
                     vxm_error *error);

/** Reports progress; VXM_ERROR_CANCELLED if the callback asks to stop. It is called from the thread that made
 * the call: in a loop of vxm_parallel the other threads report nothing. */
vxm_status vxm_progress(vxm_context *context, const char *phase, double fraction, vxm_error *error);

/**
 * Asks whether to go on, with what the thread has told last, where some time has passed since it did. For
 * loops over all elements of something large, which are to end soon when the work is cancelled: to be called
 * every so many thousand steps, within some milliseconds. A worker of vxm_parallel hears whether the loop's
 * caller was told to stop. @return VXM_OK, VXM_ERROR_CANCELLED
 */
vxm_status vxm_check_cancelled(vxm_context *context, vxm_error *error);

/** Steps of a simple loop between two calls of vxm_check_cancelled. */
enum { VXM_CANCEL_STEPS = 1 << 14 };

/** vxm_check_cancelled at every VXM_CANCEL_STEPS-th step of a loop. */
static inline vxm_status vxm_check_cancelled_at(size_t step, vxm_context *context, vxm_error *error) {
  return step % VXM_CANCEL_STEPS != 0 ? VXM_OK : vxm_check_cancelled(context, error);
}

/** A part of a longer piece of work. */
typedef struct vxm_progress_part {
  double begin, span;
} vxm_progress_part;

/** Until vxm_progress_leave is called with what this returns, fractions that the thread tells are those of
 * the part from `begin` to `end` of what it tells them of now. */
vxm_progress_part vxm_progress_enter(double begin, double end);
void vxm_progress_leave(vxm_progress_part before);

#ifdef __cplusplus
}
#endif
#endif
