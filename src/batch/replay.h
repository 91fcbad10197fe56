/* SPDX-License-Identifier: BSD-3-Clause */
/** What a journal tells of a batch: the state in which a run goes on. */
#ifndef VXM_BATCH_REPLAY_H
#define VXM_BATCH_REPLAY_H

#include "batch/supervisor.h"

/** The SHA-256 of an item's file, as far as it tells files apart. */
typedef struct batch_content {
  uint64_t half[2]; /**< 0, 0 = not known */
} batch_content;

/** Of a file that cannot be read: it is no duplicate of anything. */
extern const batch_content batch_no_content;

/**
 * Sets status, attempts and aborted of the items, and their contents.
 *
 * @param contents one for each item
 * @return true also where there is no journal yet
 */
bool batch_replay(batch_manifest *manifest, batch_content *contents, const batch_settings *settings,
                  const char *journal, batch_error *error);
/** Takes over a digest of hexadecimal digits; false if it is none. */
bool batch_content_read(batch_content *out, const char *digest);

/** Removes "OUT/NAME" and "OUT/NAME.json". */
void batch_remove_output(const char *output, const char *name);

#endif
