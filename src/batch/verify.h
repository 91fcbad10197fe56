/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether a batch is whole: each output that its journals tell of is there with the bytes that it had. */
#ifndef VXM_BATCH_VERIFY_H
#define VXM_BATCH_VERIFY_H

#include "batch/batch.h"

typedef struct batch_verification {
  int64_t files, missing, changed; /**< outputs */
  int64_t damaged;                 /**< lines of journals */
  int64_t strangers;               /**< temporary files that a run has left */
  int64_t unfinished;              /**< meshes without an end */
} batch_verification;

/**
 * Reads all outputs again.
 *
 * @param tell called with a line for each finding
 */
bool batch_verify(batch_verification *out, const char *output, void (*tell)(const char *line, void *payload),
                  void *payload, batch_error *error);

#endif
