/* SPDX-License-Identifier: BSD-3-Clause */
/** What a reader that was stopped for a system call was up to. */
#ifndef VXM_SANDBOX_BLOCKED_SYSCALL_H
#define VXM_SANDBOX_BLOCKED_SYSCALL_H

#include <stddef.h>
#include <stdint.h>

/** Such as "open a file"; a system call without a name here is told by its number. */
void vxm_blocked_syscall_describe(char *out, size_t size, int64_t call);

#endif
