/* SPDX-License-Identifier: BSD-3-Clause */
/** What has become of a whole batch, all shards together: from its plan and its journals alone. */
#ifndef VXM_BATCH_STATE_H
#define VXM_BATCH_STATE_H

#include "batch/manifest.h"

/** The end of an item, as its last record tells. */
typedef struct batch_end {
  float wall_ms, cpu_ms;
  uint64_t peak_bytes, output_bytes;
  float contested, thin; /**< shares: of the voxels, of the surface */
  uint32_t warnings;
  char *stage, *message; /**< of what failed, or the first warning; NULL = none */
} batch_end;

typedef struct batch_state {
  batch_manifest manifest; /**< with the statuses */
  batch_end *ends;         /**< of each item */
  json_t *run;             /**< run.json */
  int shards, complete;    /**< shards that have come to their end */
  int64_t records;         /**< ends that were told, also those that later ones replace */
  int64_t damaged;         /**< lines of journals that were not whole */
} batch_state;

bool batch_state_read(batch_state *out, const char *output, batch_error *error);
/** Of all items. */
void batch_state_count(const batch_state *state, int64_t counts[BATCH_STATUSES]);
void batch_state_free(batch_state *state);

#endif
