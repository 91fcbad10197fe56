/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/context.h"
#include "base/context_struct.h"
#include "base/threads.h"

#include <stdio.h>
#include <time.h>

/* Belongs to the thread, not to the context: several may make calls in one context, each a part of its own.
 */
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

/** What the thread told last, and when: vxm_check_cancelled tells it again. */
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

vxm_status vxm_check_cancelled(vxm_context *context, vxm_error *error) {
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
