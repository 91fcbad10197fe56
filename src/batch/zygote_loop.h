/* SPDX-License-Identifier: BSD-3-Clause */
/** The zygote's own side of batch/zygote.h: what goes over the channel, and the loop. */
#ifndef VXM_BATCH_ZYGOTE_LOOP_H
#define VXM_BATCH_ZYGOTE_LOOP_H

#include "batch/zygote.h"

/** Goes before the text of a request; its standard input goes along as a descriptor. */
typedef struct batch_zygote_request {
  uint64_t ticket;
  batch_limits limits;
  size_t bytes;
} batch_zygote_request;

/** Goes before message and result, each with its zero. */
typedef struct batch_zygote_reply {
  batch_ending ending;
  size_t message_bytes, result_bytes;
} batch_zygote_reply;

/** Forks children until the other end of the channel is closed; then ends them all. */
void batch_zygote_loop(int channel, batch_work *work, void *payload);

/** In the child: it dies with its parent. False if that has gone already. */
bool batch_child_bind(pid_t parent);
/** In the child, before its work: it has its limits, a standard input or none, and standard error into the
 * pipe. */
bool batch_child_prepare(int input, int message, const batch_limits *limits);

#endif
