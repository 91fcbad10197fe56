/* SPDX-License-Identifier: BSD-3-Clause */
/** The meshes of a batch: each with a name of its own, in an order that depends on the names alone. */
#ifndef VXM_BATCH_MANIFEST_H
#define VXM_BATCH_MANIFEST_H

#include "batch/batch.h"

#include <stddef.h>

typedef struct batch_item {
  char *id;      /**< unique: what journals, tables and pages call it */
  char *path;    /**< of the file, or of the archive that it is in */
  char *member;  /**< its name in the archive; NULL = a file */
  char *output;  /**< name of what is made of it, without an extension, below the folder of outputs */
  char *kind;    /**< its class; NULL = none told */
  char *split;   /**< "train" and the like; NULL = none told */
  char *options; /**< words of its own, behind those of the batch; NULL = none */
  int64_t place; /**< of a member in the archive, from 0; hard links have that of their file */
  uint64_t bytes;
  int64_t modified; /**< of the file or archive, in nanoseconds since 1970 */
  int64_t number;   /**< its place among all, of a shard or sample, too: from 0, in the order of ids */

  /* What has come of it. */
  batch_status status;
  uint8_t attempts; /**< starts with an end */
  uint8_t aborted;  /**< starts without, since the last end */
  uint8_t kills;    /**< in this run: children that were killed by others */
  bool is_misnamed; /**< its name is no UTF-8, which requests and journals are: the path may not be that of
                       the file */
  bool is_in_flight;
  bool refers_to_others; /**< what it means depends on files beside it, by a journal: it has no duplicates */
  bool is_other_beside;  /**< a file that was read beside it is another one now, and it is not to be done */
  int64_t original;      /**< the item whose bytes it has; -1 = none */
} batch_item;

typedef struct batch_manifest {
  batch_item *items;
  int64_t count, capacity;
  int64_t passed_over; /**< files in folders that are no meshes, by their names */
  char note[256];      /**< names the extensions that were passed over */
  char warning[800];   /**< of a column of a table that is not understood; "" = there is none */
  bool has_left_out;   /**< the folder of the output is one of those looked through, or within one */
} batch_manifest;

/** Adds a copy; texts may be NULL where that has a meaning. */
bool batch_manifest_add(batch_manifest *manifest, const batch_item *item, batch_error *error);
/** Sorts, refuses names that stand twice, and gives outputs their names. */
bool batch_manifest_finish(batch_manifest *manifest, batch_error *error);
/** -1 if there is none. */
int64_t batch_manifest_find(const batch_manifest *manifest, const char *id);
/** Leaves every n-th, from one on that is counted from 0. */
void batch_manifest_keep_shard(batch_manifest *manifest, int shard, int shards);
void batch_manifest_free(batch_manifest *manifest);
void batch_item_free(batch_item *item);

#endif
