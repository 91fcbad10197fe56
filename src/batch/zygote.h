/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A small process that forks a child for each piece of work, so that what happens to the child (a crash, a
 * hang, memory without end) costs that piece alone. It is forked early, while the program is small, as a fork
 * copies the tables of all that its parent holds; and the program stays out of the way of the signals of its
 * children.
 *
 * The children die with it and it dies with the program, by whatever signal; processes that a child leaves
 * behind are ended with it.
 */
#ifndef VXM_BATCH_ZYGOTE_H
#define VXM_BATCH_ZYGOTE_H

#include "batch/batch.h"

#include <stddef.h>
#include <sys/types.h>

enum {
  BATCH_REQUEST_MAX = 96 << 10, /**< bytes of a request */
  BATCH_RESULT_MAX =
      96 << 10,               /**< of what a child may say as its result; more is dropped, and is a failure */
  BATCH_MESSAGE_MAX = 4 << 10 /**< of its standard error: the first that is said is kept */
};

typedef struct batch_limits {
  double seconds;      /**< on the clock; 0 = none */
  uint64_t memory;     /**< bytes that it may hold beside what the program needs; 0 = no limit */
  uint64_t file_bytes; /**< largest file that it may write; 0 = no limit */
} batch_limits;

/**
 * What a child does.
 *
 * @param request what was sent, ended by a zero
 * @param result  descriptor to which it writes its result
 * @return its exit status
 */
typedef int batch_work(const char *request, int result, void *payload);

typedef struct batch_zygote {
  pid_t id;
  int channel; /**< -1 = none */
} batch_zygote;

/** Why a child ended. */
typedef enum batch_reason {
  BATCH_REASON_ENDED = 0, /**< by itself, or by a signal that was not ours */
  BATCH_REASON_TIMEOUT,
  BATCH_REASON_FLOOD,  /**< it did not cease to print, or its result was too long */
  BATCH_REASON_NO_FORK /**< it could not be started: the system has no room for a process */
} batch_reason;

/** How a child ended. Texts belong to the caller's buffer. */
typedef struct batch_ending {
  uint64_t ticket;
  batch_reason reason;
  int wait_status; /**< as from wait */
  double wall_ms, cpu_ms;
  uint64_t peak_bytes;
  const char *message, *result; /**< ended by a zero; "" for none */
} batch_ending;

bool batch_zygote_start(batch_zygote *out, batch_work *work, void *payload, batch_error *error);
/**
 * Asks for a child. Where the zygote has gone nothing happens: the next batch_zygote_receive says so.
 *
 * @param request shorter than BATCH_REQUEST_MAX
 * @param input   descriptor that becomes the child's standard input; -1 = none. It stays the caller's
 */
void batch_zygote_send(batch_zygote *zygote, uint64_t ticket, const char *request, int input,
                       const batch_limits *limits);
enum { BATCH_ENDING_BYTES = BATCH_RESULT_MAX + BATCH_MESSAGE_MAX + 256 };
/** Takes an ending, where poll has said that there is one; 1, 0 if there is none after all, -1 if the zygote
 * is gone. */
int batch_zygote_receive(batch_zygote *zygote, batch_ending *out, char buffer[BATCH_ENDING_BYTES]);
/** Ends it and all of its children at once. */
void batch_zygote_end(batch_zygote *zygote);

#endif
