/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/context.h"
#include "base/context_struct.h"
#include "base/machine_memory.h"
#include "base/size_text.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Every block is preceded by one cache line that holds its size, so that the counter can be lowered again. */
enum { HEADER = 64 };

static vxm_status fail_limit(vxm_error *error, const char *what, uint64_t needed, size_t limit, size_t used) {
  return vxm_fail(error, VXM_ERROR_MEMORY_LIMIT,
                  "%s needs %s, but the memory limit is %s and %s of it are in use; raise it (--memlimit) or "
                  "lower the resolution (-r)",
                  what, vxm_size_text_of(needed).text, vxm_size_text_of(limit).text,
                  vxm_size_text_of(used).text);
}

/**
 * Without a limit the machine is one. The system would hand out more than it has, and end this program, or
 * another, when it is used.
 */
static bool fits_machine(size_t used, uint64_t bytes) {
  const uint64_t small = UINT64_C(1) << 29; /* about so little nobody is asked */
  if (used < small && bytes < small)
    return true;
  const uint64_t all = vxm_machine_memory();
  return used < all && bytes <= all - used;
}

static vxm_status fail_machine(vxm_error *error, const char *what, uint64_t needed, size_t used) {
  return vxm_fail(
      error, VXM_ERROR_MEMORY_LIMIT,
      "%s needs %s, but the machine has %s and %s of it are in use here; lower the resolution (-r), "
      "or set a limit above that if it can swap (--memlimit)",
      what, vxm_size_text_of(needed).text, vxm_size_text_of(vxm_machine_memory()).text,
      vxm_size_text_of(used).text);
}

/** Books `bytes`, or says why not. */
static bool reserve(const vxm_context *owner, size_t bytes, vxm_error *error) {
  vxm_context *context = owner->account;
  size_t used = atomic_load_explicit(&context->used, memory_order_relaxed);
  do
    if (context->limit == SIZE_MAX && !fits_machine(used, bytes)) {
      fail_machine(error, "this step", bytes, used);
      return false;
    } else if (bytes > context->limit - (used < context->limit ? used : context->limit)) {
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

void vxm_store_empty(vxm_context *context) {
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
    vxm_store_empty(context);
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

static void *try_allocate(vxm_context *context, size_t count, size_t size, bool zero, vxm_status *status,
                          vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  void *block = allocate(context, count, size, zero, &local);
  if (!block) {
    *status = local.code;
    vxm_error_pass(error, &local);
  }
  return block;
}

void *vxm_try_alloc(vxm_context *context, size_t count, size_t size, vxm_status *status, vxm_error *error) {
  return try_allocate(context, count, size, false, status, error);
}

void *vxm_try_calloc(vxm_context *context, size_t count, size_t size, vxm_status *status, vxm_error *error) {
  return try_allocate(context, count, size, true, status, error);
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
  size_t used = atomic_load_explicit(&context->used, memory_order_relaxed);
  if (context->limit == SIZE_MAX)
    return fits_machine(used, bytes) ? VXM_OK : fail_machine(error, what, bytes, used);
  if (bytes <= vxm_memory_left(context))
    return VXM_OK;
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

vxm_status vxm_renew(vxm_context *context, void **array, size_t *capacity, size_t needed, size_t size,
                     vxm_error *error) {
  if (needed <= *capacity)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  vxm_free(context, *array);
  *array = vxm_alloc(context, needed, size, &local);
  *capacity = *array ? needed : 0;
  if (!*array)
    vxm_error_pass(error, &local);
  return local.code;
}
