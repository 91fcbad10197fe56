/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/threads.h"
#include "base/context_struct.h"

#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct worker_start {
  vxm_pool *pool;
  int worker;
} worker_start;

void vxm_pool_init(vxm_pool *pool) {
  pool->process = getpid();
  pthread_mutex_init(&pool->owner, NULL);
  pthread_mutex_init(&pool->mutex, NULL);
  pthread_cond_init(&pool->wake, NULL);
  pthread_cond_init(&pool->done, NULL);
}

/**
 * Waits a little for something that will mostly come within microseconds, before the thread goes to sleep:
 * loops often follow each other closely, and waking a thread takes longer than many of them.
 */
#define WAIT_A_LITTLE(condition)                             \
  for (int spin = 0; spin < SPINS && !(condition); spin++) { \
    pause_a_moment();                                        \
  }

enum { SPINS = 1000 /**< some tens of microseconds */ };

static inline void pause_a_moment(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ __volatile__("isb"); /* about as long as the pause of x86, which yield is not */
#endif
}

/** The pool whose loop the thread works on. */
static _Thread_local vxm_pool *at_work;

void vxm_loop_stop(void) {
  if (at_work)
    atomic_store_explicit(&at_work->stop, true, memory_order_relaxed);
}

/** Of a thread that another than a pool has started. */
static _Thread_local const atomic_bool *told_to_stop;

bool vxm_loop_stopped(void) {
  return (at_work && atomic_load_explicit(&at_work->stop, memory_order_relaxed)) ||
         (told_to_stop && atomic_load_explicit(told_to_stop, memory_order_relaxed));
}

static void run_tasks(vxm_pool *pool, int worker) {
  for (;;) {
    size_t task = atomic_fetch_add_explicit(&pool->next_task, 1, memory_order_relaxed);
    if (task >= pool->task_count)
      return;
    pool->function(task, worker, pool->payload);
  }
}

static _Thread_local bool is_worker;

bool vxm_is_worker(void) {
  return is_worker;
}

void vxm_worker_begin(const atomic_bool *stop) {
  is_worker = true;
  told_to_stop = stop;
}

static void *worker_main(void *argument) {
  is_worker = true;
  worker_start start = *(worker_start *)argument;
  free(argument);
  vxm_pool *pool = at_work = start.pool;
  uint64_t seen = 0;
  for (;;) {
    WAIT_A_LITTLE(atomic_load(&pool->quit) || atomic_load(&pool->round) != seen);
    pthread_mutex_lock(&pool->mutex);
    while (!pool->quit && pool->round == seen)
      pthread_cond_wait(&pool->wake, &pool->mutex);
    bool quit = pool->quit, takes_part = start.worker <= pool->participants;
    seen = pool->round;
    pthread_mutex_unlock(&pool->mutex);
    if (quit)
      return NULL;
    if (!takes_part)
      continue; /* fewer tasks than workers */
    run_tasks(pool, start.worker);
    if (atomic_fetch_sub(&pool->busy, 1) == 1) {
      pthread_mutex_lock(&pool->mutex); /* so that the caller is not between looking and sleeping */
      pthread_cond_signal(&pool->done);
      pthread_mutex_unlock(&pool->mutex);
    }
  }
}

/**
 * Starts the workers on first use; fewer than asked for is not an error, the work is only slower. They take
 * no signals, which are the application's.
 */
static void start_workers(vxm_pool *pool, int wanted) {
  sigset_t all, before;
  pool->threads = calloc((size_t)wanted, sizeof *pool->threads);
  if (!pool->threads)
    return;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  while (pool->started < wanted) {
    worker_start *start = malloc(sizeof *start);
    if (!start)
      break;
    *start = (worker_start){pool, pool->started + 1};
    if (pthread_create(&pool->threads[pool->started], NULL, worker_main, start) != 0) {
      free(start);
      break;
    }
    pool->started++;
  }
  pthread_sigmask(SIG_SETMASK, &before, NULL);
}

/** After a fork the child has the pool's memory but none of its threads, and its locks may be held for ever.
 */
static bool is_forked(const vxm_pool *pool) {
  return pool->process != getpid();
}

void vxm_pool_destroy(vxm_pool *pool) {
  if (is_forked(pool)) {
    free(pool->threads);
    return;
  }
  pthread_mutex_lock(&pool->mutex);
  pool->quit = true;
  pthread_cond_broadcast(&pool->wake);
  pthread_mutex_unlock(&pool->mutex);
  for (int i = 0; i < pool->started; i++)
    pthread_join(pool->threads[i], NULL);
  free(pool->threads);
  pthread_cond_destroy(&pool->done);
  pthread_cond_destroy(&pool->wake);
  pthread_mutex_destroy(&pool->mutex);
  pthread_mutex_destroy(&pool->owner);
}

void vxm_parallel(vxm_context *context, size_t count, vxm_task_fn function, void *payload) {
  vxm_pool *pool = &context->crew->pool;
  /* trylock fails for a nested loop and for a second caller: both work alone. */
  if (context->threads < 2 || count < 2 || is_forked(pool) || pthread_mutex_trylock(&pool->owner) != 0) {
    for (size_t task = 0; task < count; task++)
      function(task, 0, payload);
    return;
  }
  pthread_mutex_lock(&pool->mutex);
  if (pool->round == 0)
    start_workers(pool, context->threads - 1);
  pool->function = function;
  pool->payload = payload;
  pool->task_count = count;
  atomic_store_explicit(&pool->next_task, 0, memory_order_relaxed);
  atomic_store_explicit(&pool->stop, false, memory_order_relaxed);
  pool->participants = count - 1 < (size_t)pool->started ? (int)(count - 1) : pool->started;
  atomic_store(&pool->busy, pool->participants);
  atomic_fetch_add(&pool->round, 1);
  pthread_cond_broadcast(&pool->wake);
  pthread_mutex_unlock(&pool->mutex);

  vxm_pool *before = at_work;
  at_work = pool;
  run_tasks(pool, 0);
  at_work = before;

  WAIT_A_LITTLE(atomic_load(&pool->busy) == 0);
  if (atomic_load(&pool->busy) > 0) {
    pthread_mutex_lock(&pool->mutex);
    while (atomic_load(&pool->busy) > 0)
      pthread_cond_wait(&pool->done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
  }
  pthread_mutex_unlock(&pool->owner);
}

typedef struct asked {
  vxm_task_fn function;
  void *payload;
  vxm_context *context;
  atomic_bool stop;
  vxm_status status; /**< written by worker 0 only, which is the caller */
  vxm_error *error;
} asked;

static void run_asked(size_t task, int worker, void *payload) {
  asked *p = payload;
  if (worker == 0 && p->status == VXM_OK) {
    p->status = vxm_check_cancelled(p->context, p->error);
    if (p->status != VXM_OK)
      atomic_store_explicit(&p->stop, true, memory_order_relaxed);
  }
  if (!atomic_load_explicit(&p->stop, memory_order_relaxed))
    p->function(task, worker, p->payload);
}

vxm_status vxm_parallel_cancellable(vxm_context *context, size_t count, vxm_task_fn function, void *payload,
                                    vxm_error *error) {
  asked p = {.function = function, .payload = payload, .context = context, .error = error};
  vxm_parallel(context, count, run_asked, &p);
  return p.status == VXM_OK ? vxm_check_cancelled(context, error) : p.status;
}
