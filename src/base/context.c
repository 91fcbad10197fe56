/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/context.h"
#include "base/context_struct.h"
#include "base/size_text.h"
#include "base/sized.h"
#include "base/threads.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

/* Every block is preceded by one cache line that holds its size, so that the counter can be lowered again. */
enum { HEADER = 64 };

static void empty_store(vxm_context *context);

static int available_processors(void) {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) {
    int count = CPU_COUNT(&set);
    if (count > 0)
      return count;
  }
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  return online > 0 ? (int)online : 1;
}

vxm_status vxm_context_create(vxm_context **out, const vxm_context_options *options, vxm_error *error) {
  if (!out)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "context: the output argument is NULL");
  *out = NULL;
  vxm_context_options chosen = VXM_CONTEXT_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "context", error);
  if (status != VXM_OK)
    return status;
  if (chosen.threads < 0 || chosen.threads > VXM_THREADS_MAX)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "context: %d threads; choose 0 (all processors) to %d",
                    chosen.threads, VXM_THREADS_MAX);
  vxm_context *context = calloc(1, sizeof *context);
  if (!context)
    return vxm_fail(error, VXM_ERROR_MEMORY, "context: out of memory");
  atomic_init(&context->references, 1);
  context->account = context->crew = context->asks = context;
  atomic_init(&context->used, 0);
  atomic_init(&context->peak, 0);
  context->limit = chosen.memory_limit ? (size_t)chosen.memory_limit : SIZE_MAX;
  context->threads = chosen.threads ? chosen.threads : available_processors();
  if (context->threads > VXM_THREADS_MAX)
    context->threads = VXM_THREADS_MAX;
  context->ask_ms = 20;
  context->progress = chosen.progress;
  context->payload = chosen.payload;
  vxm_pool_init(&context->pool);
  pthread_mutex_init(&context->held.mutex, NULL);
  *out = context;
  return VXM_OK;
}

vxm_status vxm_context_acquire(vxm_context **out, vxm_context *context, vxm_error *error) {
  if (!context)
    return vxm_context_create(out, NULL, error);
  atomic_fetch_add_explicit(&context->references, 1, memory_order_relaxed);
  *out = context;
  return VXM_OK;
}

void vxm_context_release(vxm_context *context) {
  if (!context || atomic_fetch_sub_explicit(&context->references, 1, memory_order_acq_rel) != 1)
    return;
  if (context->keeps) {
    empty_store(context);
    pthread_mutex_destroy(&context->store.mutex);
  }
  if (context->crew != context)
    vxm_context_release(context->crew);
  if (context->account != context)
    vxm_context_release(context->account);
  vxm_pool_destroy(&context->pool);
  vxm_file_transaction_drop(context->held.first);
  pthread_mutex_destroy(&context->held.mutex);
  free(context);
}

vxm_status vxm_context_child(vxm_context **out, vxm_context *parent, bool alone, vxm_error *error) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = alone ? 1 : parent->threads;
  options.progress = alone ? NULL : parent->progress;
  options.payload = parent->payload;
  vxm_status status = vxm_context_create(out, &options, error);
  if (status != VXM_OK)
    return status;
  vxm_context *child = *out;
  child->keeps = true;
  child->asks = parent->asks; /* which lives as long as the account does */
  pthread_mutex_init(&child->store.mutex, NULL);
  status = vxm_context_acquire(&child->account, parent->account, error);
  return alone || status != VXM_OK ? status : vxm_context_acquire(&child->crew, parent->crew, error);
}

void vxm_context_destroy(vxm_context *context) {
  vxm_context_release(context);
}

int vxm_context_threads(const vxm_context *context) {
  return context ? context->threads : available_processors();
}

uint64_t vxm_context_peak_bytes(const vxm_context *context) {
  return context ? atomic_load_explicit(&context->account->peak, memory_order_relaxed) : 0;
}

static vxm_status fail_limit(vxm_error *error, const char *what, uint64_t needed, size_t limit, size_t used) {
  return vxm_fail(error, VXM_ERROR_MEMORY_LIMIT,
                  "%s needs %s, but the memory limit is %s and %s of it are in use; raise it (--memlimit) or "
                  "lower the resolution (-r)",
                  what, vxm_size_text_of(needed).text, vxm_size_text_of(limit).text,
                  vxm_size_text_of(used).text);
}

/** Books `bytes`, or says why not. */
static bool reserve(const vxm_context *owner, size_t bytes, vxm_error *error) {
  vxm_context *context = owner->account;
  size_t used = atomic_load_explicit(&context->used, memory_order_relaxed);
  do
    if (bytes > context->limit - (used < context->limit ? used : context->limit)) {
      fail_limit(error, "this step", bytes, context->limit, used);
      return false;
    }
  while (!atomic_compare_exchange_weak_explicit(&context->used, &used, used + bytes, memory_order_relaxed,
                                                memory_order_relaxed));
  size_t now = used + bytes;
  size_t peak = atomic_load_explicit(&context->peak, memory_order_relaxed);
  while (peak < now && !atomic_compare_exchange_weak_explicit(&context->peak, &peak, now,
                                                              memory_order_relaxed, memory_order_relaxed))
    ;
  return true;
}

static void unreserve(const vxm_context *context, size_t bytes) {
  atomic_fetch_sub_explicit(&context->account->used, bytes, memory_order_relaxed);
}

/** Size of a block with its header and padding, or 0 if the product overflows. */
static size_t block_bytes(size_t count, size_t size) {
  size_t bytes;
  if (__builtin_mul_overflow(count, size, &bytes) || bytes > PTRDIFF_MAX - 2 * HEADER)
    return 0;
  return (bytes + HEADER + HEADER - 1) / HEADER * HEADER;
}

static void fail_memory(vxm_error *error, size_t bytes) {
  vxm_fail(error, VXM_ERROR_MEMORY, "out of memory (%s asked for); lower the resolution or free some memory",
           vxm_size_text_of(bytes).text);
}

/* Large zeroed blocks come from calloc, whose fresh pages need no clearing; calloc aligns to 16 only, so the
   block is placed at the next multiple of 64 and the start is remembered. */
typedef struct vxm_block_header {
  void *start;
  size_t bytes;
  struct vxm_block_header *next; /**< of those in a store */
} block_header;

static block_header *header_of(void *block) {
  return (block_header *)((char *)block - HEADER);
}

/** Asks for large pages in a large block: faults of 4 KiB each would cost more than filling it does. */
static void advise_large(char *start, size_t bytes) {
#ifdef MADV_HUGEPAGE
  enum { LARGE = 4 << 20 };
  if (bytes < LARGE)
    return;
  uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), skip = (page - (uintptr_t)start % page) % page;
  /* Only advice: whether it is taken changes no result. */
  (void)madvise(start + skip, (bytes - skip) / page * page, MADV_HUGEPAGE);
#else
  (void)start;
  (void)bytes;
#endif
}

/* ---- Blocks that wait for a use ---- */

/** Gives a block back to the system. */
static void give_back(vxm_context *context, const block_header *header) {
  unreserve(context, header->bytes);
  free(header->start);
}

static void empty_store(vxm_context *context) {
  for (block_header *header = context->store.first, *next; header; header = next) {
    next = header->next;
    give_back(context, header);
  }
  context->store.first = NULL;
}

/** Takes the least block of at least so many bytes out of the store; NULL if there is none. */
static block_header *take_least(vxm_store *store, size_t bytes) {
  block_header **best = NULL;
  for (block_header **at = &store->first; *at; at = &(*at)->next)
    if ((*at)->bytes >= bytes && (!best || (*at)->bytes < (*best)->bytes))
      best = at;
  if (!best)
    return NULL;
  block_header *header = *best;
  *best = header->next;
  return header;
}

/** Gives the greatest block of the store back: a greater one takes its place, and so the store does not grow
 * without end. */
static void drop_greatest(vxm_context *context) {
  block_header **most = &context->store.first;
  for (block_header **at = most; *at; at = &(*at)->next)
    if ((*at)->bytes > (*most)->bytes)
      most = at;
  block_header *header = *most;
  if (!header)
    return;
  *most = header->next;
  give_back(context, header);
}

/** Rounds up by a quarter at most, so that sizes which vary a little do not each want a block of their own.
 */
static size_t round_up(size_t bytes) {
  size_t step = HEADER;
  while (step < bytes / 8)
    step *= 2;
  return (bytes + step - 1) / step * step;
}

/** A block from the store; NULL if a new one of *bytes bytes is to be made, whatever is kept. */
static void *take_kept(vxm_context *context, size_t *bytes, bool zero) {
  *bytes = round_up(*bytes);
  pthread_mutex_lock(&context->store.mutex);
  block_header *header = take_least(&context->store, *bytes);
  if (!header)
    drop_greatest(context);
  if (!header && *bytes > vxm_memory_left(context))
    empty_store(context);
  pthread_mutex_unlock(&context->store.mutex);
  if (!header)
    return NULL;
  void *block = (char *)header + HEADER;
  if (zero)
    memset(block, 0, *bytes - 2 * HEADER);
  return block;
}

static void keep(vxm_context *context, block_header *header) {
  pthread_mutex_lock(&context->store.mutex);
  header->next = context->store.first;
  context->store.first = header;
  pthread_mutex_unlock(&context->store.mutex);
}

/* ---- Allocating ---- */

static void *allocate(vxm_context *context, size_t count, size_t size, bool zero, vxm_error *error) {
  size_t bytes = block_bytes(count, size);
  if (bytes == 0) {
    vxm_fail(error, VXM_ERROR_RANGE, "a size of %zu x %zu bytes is beyond what can be addressed", count,
             size);
    return NULL;
  }
  bytes += HEADER;
  if (context->keeps) {
    void *kept = take_kept(context, &bytes, zero);
    if (kept)
      return kept;
  }
  if (!reserve(context, bytes, error))
    return NULL;
  char *start = zero ? calloc(1, bytes) : malloc(bytes);
  if (!start) {
    unreserve(context, bytes);
    fail_memory(error, bytes);
    return NULL;
  }
  advise_large(start, bytes);
  uintptr_t aligned = ((uintptr_t)start + HEADER + HEADER - 1) / HEADER * HEADER;
  void *block = start + (aligned - (uintptr_t)start);
  *header_of(block) = (block_header){start, bytes, NULL};
  return block;
}

void *vxm_alloc(vxm_context *context, size_t count, size_t size, vxm_error *error) {
  return allocate(context, count, size, false, error);
}

void *vxm_calloc(vxm_context *context, size_t count, size_t size, vxm_error *error) {
  return allocate(context, count, size, true, error);
}

/** Into a block that is larger. */
static void *move_block(vxm_context *context, void *block, size_t count, size_t size, vxm_error *error) {
  void *moved = vxm_alloc(context, count, size, error);
  if (!moved)
    return NULL;
  memcpy(moved, block, header_of(block)->bytes - 2 * HEADER);
  vxm_free(context, block);
  return moved;
}

void *vxm_realloc(vxm_context *context, void *block, size_t count, size_t size, vxm_error *error) {
  if (!block)
    return vxm_alloc(context, count, size, error);
  block_header old = *header_of(block);
  size_t bytes = block_bytes(count, size);
  if (bytes == 0)
    return vxm_alloc(context, count, size, error);
  bytes += HEADER;
  if (bytes == old.bytes || (context->keeps && bytes < old.bytes))
    return block;
  if (context->keeps)
    return move_block(context, block, count, size, error);
  if (bytes > old.bytes && !reserve(context, bytes - old.bytes, error))
    return NULL;
  size_t old_shift = (size_t)((char *)block - (char *)old.start);
  char *start = realloc(old.start, bytes);
  if (!start) {
    if (bytes > old.bytes)
      unreserve(context, bytes - old.bytes);
    fail_memory(error, bytes);
    return NULL;
  }
  if (bytes < old.bytes)
    unreserve(context, old.bytes - bytes);
  else
    advise_large(start, bytes);
  /* realloc may land on another alignment: move the content to its aligned place. */
  uintptr_t aligned = ((uintptr_t)start + HEADER + HEADER - 1) / HEADER * HEADER;
  size_t shift = (size_t)(aligned - (uintptr_t)start);
  size_t kept = (bytes < old.bytes ? bytes : old.bytes) - 2 * HEADER;
  if (shift != old_shift)
    memmove(start + shift, start + old_shift, kept);
  void *moved = start + shift;
  *header_of(moved) = (block_header){start, bytes, NULL};
  return moved;
}

void vxm_free(vxm_context *context, void *block) {
  if (!block)
    return;
  block_header *header = header_of(block);
  if (context->keeps)
    keep(context, header);
  else
    give_back(context, header);
}

size_t vxm_memory_left(const vxm_context *owner) {
  const vxm_context *context = owner->account;
  if (context->limit == SIZE_MAX)
    return SIZE_MAX;
  size_t used = atomic_load_explicit(&context->used, memory_order_relaxed);
  return used < context->limit ? context->limit - used : 0;
}

vxm_status vxm_memory_check(const vxm_context *owner, uint64_t bytes, const char *what, vxm_error *error) {
  const vxm_context *context = owner->account;
  if (bytes <= vxm_memory_left(context))
    return VXM_OK;
  size_t used = atomic_load_explicit(&context->used, memory_order_relaxed);
  return fail_limit(error, what, bytes, context->limit, used);
}

vxm_status vxm_memory_take(vxm_context *context, size_t bytes, vxm_error *error) {
  return reserve(context, bytes, error) ? VXM_OK : VXM_ERROR_MEMORY_LIMIT;
}

void vxm_memory_give(vxm_context *context, size_t bytes) {
  unreserve(context, bytes);
}

vxm_status vxm_grow(vxm_context *context, void **array, size_t *capacity, size_t needed, size_t size,
                    vxm_error *error) {
  if (needed <= *capacity)
    return VXM_OK;
  size_t wanted = *capacity < 16 ? 16 : *capacity + *capacity / 2;
  if (wanted < needed)
    wanted = needed;
  vxm_error local = VXM_ERROR_INIT;
  void *grown = vxm_realloc(context, *array, wanted, size, &local);
  if (!grown) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  *array = grown;
  *capacity = wanted;
  return VXM_OK;
}

static _Thread_local vxm_progress_part part = {0, 1};

vxm_progress_part vxm_progress_enter(double begin, double end) {
  vxm_progress_part before = part;
  part.begin += part.span * begin;
  part.span *= end - begin;
  return before;
}

void vxm_progress_leave(vxm_progress_part before) {
  part = before;
}

/** What the thread told last, and when: vxm_ask tells it again. */
static _Thread_local struct told {
  char phase[48];
  double fraction;
  int64_t ms;
} told = {"working", 0, 0};

static int64_t coarse_ms(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC_COARSE, &time);
  return (int64_t)time.tv_sec * 1000 + time.tv_nsec / 1000000;
}

vxm_status vxm_fail_cancelled(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_CANCELLED, "cancelled while %s", told.phase);
}

static vxm_status tell(const vxm_context *context, vxm_error *error) {
  if (context->progress(told.phase, told.fraction, context->payload) == 0)
    return VXM_OK;
  vxm_loop_stop();
  return vxm_fail_cancelled(error);
}

vxm_status vxm_progress(vxm_context *context, const char *phase, double fraction, vxm_error *error) {
  if (!context->progress || vxm_is_worker())
    return VXM_OK;
  snprintf(told.phase, sizeof told.phase, "%s", phase);
  told.fraction = part.begin + part.span * fraction;
  told.ms = coarse_ms();
  return tell(context, error);
}

vxm_status vxm_ask(vxm_context *context, vxm_error *error) {
  if (vxm_is_worker())
    return vxm_loop_stopped() ? vxm_fail_cancelled(error) : VXM_OK;
  const vxm_context *asks = context->asks;
  if (!asks->progress)
    return VXM_OK;
  int64_t now = coarse_ms();
  if (now - told.ms < asks->ask_ms)
    return VXM_OK;
  told.ms = now;
  return tell(asks, error);
}
