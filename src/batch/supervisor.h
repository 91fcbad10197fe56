/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Runs a batch: gives out its meshes, a child each, writes the journal, and comes to an end whatever the
 * children do. It is a single thread that waits for messages. What it is told by a journal of a run before is
 * not done again.
 */
#ifndef VXM_BATCH_SUPERVISOR_H
#define VXM_BATCH_SUPERVISOR_H

#include "batch/archive.h"
#include "batch/journal.h"
#include "batch/manifest.h"
#include "batch/zygote.h"

typedef struct batch_settings {
  const char *output; /**< the folder, which is there */
  int shard, shards;  /**< shard counts from 0 */
  int jobs;           /**< children at a time */
  batch_limits limits;
  uint64_t alone_memory; /**< what a mesh may take that ran out of limits.memory, when it runs alone; 0 = no
                            second try */
  bool retry[BATCH_STATUSES]; /**< those of a run before with these statuses are done again */
  /**
   * What is to be made of a mesh: {"commands": [[word...]...], "outputs": [name below the folder...]}, and
   * what else the work wants to know. NULL after a failure.
   *
   * @param memory bytes that it may take; 0 = no limit
   */
  json_t *(*job)(const batch_item *item, uint64_t memory, void *payload, batch_error *error);
  batch_work *work;     /**< does it, in the child: its result is an object with "status" */
  batch_zygote *zygote; /**< started early, while the program is small; taken over, and replaced by one that
                           has ended */
  void *payload;
  bool shows_progress; /**< a line that is drawn anew on standard error, which is a terminal; else one now and
                          then */
  bool is_quiet;
} batch_settings;

/** What has come of it. */
typedef struct batch_tally {
  int64_t counts[BATCH_STATUSES]; /**< of the shard's meshes: all, BATCH_PENDING too */
  int64_t total, done_before;     /**< done_before: in a run before */
  int64_t fresh;                  /**< ended in this run */
  double started_ms;
} batch_tally;

/** How a run ended. */
typedef enum batch_outcome {
  BATCH_COMPLETE,    /**< each mesh has its final status */
  BATCH_INTERRUPTED, /**< by a signal: the same command goes on */
  BATCH_BROKEN       /**< the error tells; the same command goes on when that is mended */
} batch_outcome;

batch_outcome batch_run(batch_tally *tally, batch_manifest *manifest, const batch_settings *settings,
                        batch_error *error);
/** The signal that asked to stop, or 0. */
int batch_signal(void);

#endif
