/* SPDX-License-Identifier: BSD-3-Clause */
/** The fields of a context; for context.c, memory.c, progress.c, file_transaction.c and threads.c only. */
#ifndef VXM_BASE_CONTEXT_STRUCT_H
#define VXM_BASE_CONTEXT_STRUCT_H

#include "base/file_transaction.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <sys/types.h>

enum { VXM_THREADS_MAX = 256 };

typedef struct vxm_pool {
  pthread_mutex_t owner; /**< held by the caller whose work runs */
  pthread_mutex_t mutex;
  pthread_cond_t wake, done;
  pthread_t *threads;
  int started;                /**< workers that exist */
  int participants;           /**< workers that take part in the present round: those numbered 1 to this */
  atomic_int busy;            /**< of these, those still at work */
  pid_t process;              /**< the process that the pool belongs to */
  atomic_uint_fast64_t round; /**< number of the present round; changed under the mutex */
  atomic_bool quit;
  atomic_bool stop; /**< the present round's caller has been told to stop */
  void (*function)(size_t task, int worker, void *payload);
  void *payload;
  size_t task_count;
  atomic_size_t next_task;
} vxm_pool;

void vxm_pool_init(vxm_pool *pool);
void vxm_pool_destroy(vxm_pool *pool);

/** Blocks that were freed and wait for a use. */
typedef struct vxm_store {
  pthread_mutex_t mutex;
  struct vxm_block_header *first;
} vxm_store;

struct vxm_context {
  atomic_uint references;
  vxm_context *account; /**< where memory is counted: itself, or the context that it is a child of */
  vxm_context *crew;    /**< whose threads work: itself, or its parent */
  vxm_context *asks;    /**< whose caller is asked whether to go on: itself, or its parent's; no reference */
  bool keeps;           /**< freed blocks go to the store */
  vxm_store store;
  atomic_size_t used, peak;
  size_t limit;
  int threads;
  int ask_ms; /**< between two questions whether to go on, at least; tests that want all of them make it 0 */
  vxm_progress_fn progress;
  void *payload;
  vxm_pool pool;
  vxm_file_transaction held; /**< of the account */
};

/** Gives all blocks of a context's store back to the system. */
void vxm_store_empty(vxm_context *context);

#endif
