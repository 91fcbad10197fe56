/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A program that does a piece of work in a process of its own, and is talked to over a pair of sockets. Work
 * that may crash, hang or take all memory, such as a foreign library on a damaged file, then ends that
 * process and not the caller's.
 */
#ifndef VXM_BASE_PROCESS_H
#define VXM_BASE_PROCESS_H

#include "base/context.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct vxm_process {
  pid_t id;
  int channel;          /**< our end of the sockets; the program's end is its standard input */
  vxm_context *context; /**< whose progress is told while we wait */
  const char *phase;
  double fraction; /**< of the phase; may be changed between calls */
  double told_ms;  /**< when progress was told last */
  double limit_ms; /**< how long we wait for it in all; 0 = for ever. May be changed between calls */
  double waited_ms, seen_ms; /**< so far, and when that was */
} vxm_process;

/**
 * Starts a program. Its standard input is the channel, both ways; what it prints is dropped. It has a session
 * of its own, so that signals from the terminal do not reach it, starts with all signals at their defaults,
 * and gets nothing of our environment but where libraries lie.
 *
 * @param arguments from the program's name on, NULL behind the last
 * @return VXM_OK; VXM_ERROR_IO if it cannot be started, then there is nothing to end
 */
vxm_status vxm_process_start(vxm_process *out, vxm_context *context, const char *phase, const char *program,
                             char *const arguments[], vxm_error *error);

/* Both wait until everything went over, telling progress meanwhile.
 * VXM_ERROR_IO without a message if the program has gone or is late; VXM_ERROR_CANCELLED */
vxm_status vxm_process_send(vxm_process *process, const void *data, size_t size, vxm_error *error);
vxm_status vxm_process_receive(vxm_process *process, void *data, size_t size, vxm_error *error);

/** Whether we have waited for as long as we would. */
bool vxm_process_is_late(const vxm_process *process);

/** Lets the program hold and compute so much more, as far as its hard limits go. */
void vxm_process_allow(const vxm_process *process, uint64_t bytes, uint64_t seconds);

/**
 * Ends the program and those that it has started, by force if it has not ended by itself. Returns its status
 * as from waitpid; 0 if the caller's program has collected it already, or collects none.
 */
int vxm_process_end(vxm_process *process);

#endif
