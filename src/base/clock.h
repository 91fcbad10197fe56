/* SPDX-License-Identifier: BSD-3-Clause */
/** Time that passes, for reports. */
#ifndef VXM_BASE_CLOCK_H
#define VXM_BASE_CLOCK_H

#include <time.h>

/** Milliseconds since an arbitrary start. */
static inline double vxm_clock_ms(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

#endif
