/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A child with all that it may start, in a space of processes of its own (pid_namespaces(7)): its first
 * process only waits for the second, which works; when the first ends, by itself or killed, the kernel ends
 * all others, however many they are and wherever they have gone. Where the system allows no such space (a
 * container may not) children are plain ones, and what they leave is looked for.
 */
#ifndef VXM_BATCH_CAGE_H
#define VXM_BATCH_CAGE_H

#include <stdbool.h>
#include <sys/types.h>

typedef struct batch_cage {
  bool has_spaces; /**< whether the system gives us any */
} batch_cage;

/** Finds out whether spaces can be made, if need be by taking a space of users first. */
batch_cage batch_cage_open(void);
/**
 * As fork, but in a space of its own if there are any. In the child it returns 0 in the process that is to
 * work, when its parent still lives; -1 = it cannot.
 *
 * @param[out] status descriptor from which batch_cage_status reads; -1 = the child is a plain one
 */
pid_t batch_cage_fork(const batch_cage *cage, int *status);
/** How the process that works has ended, as from wait; false if that is not known: it ended with the first
 * one. */
bool batch_cage_status(int status, int *wait_status);

#endif
