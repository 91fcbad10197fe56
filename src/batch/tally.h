/* SPDX-License-Identifier: BSD-3-Clause */
/** Counts, and the line that shows how far a batch has come. */
#ifndef VXM_BATCH_TALLY_H
#define VXM_BATCH_TALLY_H

#include "batch/supervisor.h"

/** "4 812 ok, 12 degraded, 3 failed": those that are not 0, but what is pending. */
const char *batch_counts_text(char text[320], const int64_t counts[BATCH_STATUSES]);
/** {"pending": 0, "ok": 4812, ...}, of all statuses. */
json_t *batch_counts_json(const int64_t counts[BATCH_STATUSES]);
/** "3 min 20 s" */
const char *batch_duration_text(char text[40], double seconds);

/** Shows the progress, if it is time to. */
void batch_progress(const batch_tally *tally, const batch_settings *settings, int in_flight);
/** Clears the line. */
void batch_progress_clear(const batch_settings *settings);

#endif
