/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A child with all that it may start, in a PID namespace of its own (pid_namespaces(7)): its first process
 * only waits for the second, which works; when the first ends, by itself or killed, the kernel ends all
 * others, however many they are and wherever they have gone. Where the system allows no namespaces (a
 * container may not) children are plain ones, and what they leave is looked for.
 */
#ifndef VXM_BATCH_PID_NAMESPACE_H
#define VXM_BATCH_PID_NAMESPACE_H

#include <stdbool.h>
#include <sys/types.h>

/** Finds out whether PID namespaces can be made, if need be by entering a user namespace first. */
bool batch_pid_namespaces_open(void);
/**
 * As fork, but in a namespace of its own if `has_namespaces`. In the child it returns 0 in the process that
 * is to work, when its parent still lives; -1 = it cannot.
 *
 * @param[out] status descriptor from which batch_namespace_status reads; -1 = the child is a plain one
 */
pid_t batch_namespace_fork(bool has_namespaces, int *status);
/** How the process that works has ended, as from wait; false if that is not known: it ended with the first
 * one. */
bool batch_namespace_status(int status, int *wait_status);

#endif
