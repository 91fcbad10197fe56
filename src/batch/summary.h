/* SPDX-License-Identifier: BSD-3-Clause */
/** What a batch leaves for its user: summary.json, failures.tsv and index.html in the folder of outputs. */
#ifndef VXM_BATCH_SUMMARY_H
#define VXM_BATCH_SUMMARY_H

#include "batch/state.h"

/** What the summary needs of its caller, who knows the commands. */
typedef struct batch_summary_hooks {
  int pictures; /**< how many at most */
  /** The command that repeats what failed at a stage of an item, to be freed. */
  char *(*command_line)(const batch_item *item, const char *stage, void *payload);
  /** The name of the output that can be looked at, below the folder, to be freed; NULL = none. */
  char *(*viewed)(const batch_item *item, void *payload);
  /** Draws a file that was made of an item as a small PNG; false if that cannot be. */
  bool (*draw)(const batch_item *item, const char *path, const char *picture, void *payload);
  void *payload;
} batch_summary_hooks;

/** Counts and sums over all items, to be released; NULL without memory. */
json_t *batch_summary_json(const batch_state *state);
/** Writes all three, from the state of all shards. */
bool batch_summary_write(const batch_state *state, const char *output, const batch_summary_hooks *hooks,
                         batch_error *error);
/** The page alone. */
bool batch_page_write(const batch_state *state, const json_t *summary, const char *output,
                      const batch_summary_hooks *hooks, batch_error *error);

#endif
