/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What has happened, line by line: the truth about a batch. Lines are only ever added, by one writer, and
 * each carries the beginning of the SHA-256 of the rest of it, so that one that was cut off or damaged is
 * known.
 *
 * {"sum":"0123456789abcdef","event":"start","item":"chair_0001.off","attempt":1}
 */
#ifndef VXM_BATCH_JOURNAL_H
#define VXM_BATCH_JOURNAL_H

#include "batch/batch.h"

typedef struct batch_journal {
  int descriptor, folder; /**< the folder whose file system has the outputs, too */
  const char *path;
  double synced_ms;
  bool is_dirty;
} batch_journal;

/**
 * Opens a journal to add to, cuts off a line that was not written to its end, and keeps others from adding.
 *
 * @param path kept until it is closed
 */
bool batch_journal_open(batch_journal *out, const char *path, int folder, batch_error *error);
/** Adds a record, which is given away. What it tells of, outputs included, is on disk some seconds later. */
bool batch_journal_add(batch_journal *journal, json_t *record, batch_error *error);
/** Waits until all is on disk. */
bool batch_journal_sync(batch_journal *journal, batch_error *error);
void batch_journal_close(batch_journal *journal);

/** Called with each record; false ends the reading, which then fails. */
typedef bool batch_record(json_t *record, void *payload);
/**
 * Reads a journal, also while it grows.
 *
 * @param[out] damaged may be NULL: lines in the midst of it that are not as they were written. They are
 * passed over, and what they told is done again
 */
bool batch_journal_read(const char *path, batch_record *each, void *payload, int64_t *damaged,
                        batch_error *error);

#endif
