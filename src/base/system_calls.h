/* SPDX-License-Identifier: BSD-3-Clause */
/** Calls of Linux that the C library may have no function for, as musl of Debian 12. */
#ifndef VXM_BASE_SYSTEM_CALLS_H
#define VXM_BASE_SYSTEM_CALLS_H

#include "config.h"

#include <stdio.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#ifndef HAVE_RENAMEAT2
#ifndef RENAME_EXCHANGE
#define RENAME_EXCHANGE (1U << 1)
#endif

static inline int renameat2(int from, const char *name, int to, const char *other, unsigned flags) {
  return (int)syscall(SYS_renameat2, from, name, to, other, flags);
}
#endif

#ifndef HAVE_CLOSE_RANGE
/** Kernels before 5.9 do not have the call: one descriptor after another. */
static inline int close_range(unsigned first, unsigned last, int flags) {
  struct rlimit most;
  if (syscall(SYS_close_range, first, last, flags) == 0)
    return 0;
  if (getrlimit(RLIMIT_NOFILE, &most) != 0)
    return -1;
  for (unsigned descriptor = first; descriptor <= last && descriptor < most.rlim_cur; descriptor++)
    close((int)descriptor);
  return 0;
}
#endif

#ifndef HAVE_CLOSEFROM
static inline void closefrom(int first) {
  close_range((unsigned)first, ~0U, 0);
}
#endif

#endif
