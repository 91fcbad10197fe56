/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/context.h"
#include "base/c_locale.h"
#include "base/context_struct.h"
#include "base/sized.h"

#include <inttypes.h>
#include <stdlib.h>
#include <unistd.h>

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
  vxm_context *context = vxm_c_locale() ? calloc(1, sizeof *context) : NULL;
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
    vxm_store_empty(context);
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
