/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A program that does a piece of work in a process of its own, and is talked to over a pair of sockets. Work
 * that may crash, hang or take all memory, such as a foreign library on a damaged file, then ends that
 * process and not the caller's.
 */
#ifndef VXM_BASE_PROCESS_H
#define VXM_BASE_PROCESS_H

#include "base/context.h"

#include <sys/types.h>

typedef struct vxm_process {
  pid_t id;
  int channel;          /**< our end of the sockets; the program's end is its standard input */
  vxm_context *context; /**< whose progress is told while we wait */
  const char *phase;
  double fraction; /**< of the phase; may be changed between calls */
  double told_ms;  /**< when progress was told last */
} vxm_process;

/**
 * Starts a program. Its standard input is the channel, both ways; what it prints is dropped. Signals from the
 * terminal do not reach it, and it starts with all signals at their defaults.
 *
 * @param arguments from the program's name on, NULL behind the last
 * @return VXM_OK; VXM_ERROR_IO if it cannot be started, then there is nothing to end
 */
vxm_status vxm_process_start(vxm_process *out, vxm_context *context, const char *phase, const char *program,
                             char *const arguments[], vxm_error *error);

/* Both wait until everything went over, telling progress meanwhile.
 * VXM_ERROR_IO without a message if the program has gone; VXM_ERROR_CANCELLED */
vxm_status vxm_process_send(vxm_process *process, const void *data, size_t size, vxm_error *error);
vxm_status vxm_process_receive(vxm_process *process, void *data, size_t size, vxm_error *error);

/** Says that nothing more is sent: the program sees the end of its input. */
void vxm_process_sent(vxm_process *process);

/**
 * Ends the program, by force if it has not ended by itself. Returns its status as from waitpid; 0 if the
 * caller's program has collected it already, or collects none.
 */
int vxm_process_end(vxm_process *process);

#endif
