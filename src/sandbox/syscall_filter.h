/* SPDX-License-Identifier: BSD-3-Clause */
/** The filter of system calls. */
#ifndef VXM_SANDBOX_SYSCALL_FILTER_H
#define VXM_SANDBOX_SYSCALL_FILTER_H

/**
 * Lets only the system calls through that computing takes. Any other is not made: which one is told over the
 * channel, and the process ends.
 *
 * @return NULL, also where this build has no filter (configure --without-seccomp); else why it cannot be had
 */
const char *vxm_syscall_filter(int channel);

#endif
