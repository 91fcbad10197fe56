/* SPDX-License-Identifier: BSD-3-Clause */
/** Calls of Linux that the C library may have no function for, as musl of Debian 12. */
#ifndef VXM_BASE_SYSTEM_CALLS_H
#define VXM_BASE_SYSTEM_CALLS_H

#include "config.h"

#include <stdio.h>
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

#endif
