/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What a batch is to do, frozen when it begins: its meshes, its settings and its number of shards. A run that
 * goes on with it has to want the same, so that no output is of another kind than its neighbours.
 *
 * OUT/.batch/run.json      settings, shards, version, inputs, SHA-256 of the list
 * OUT/.batch/plan.jsonl    a line for each mesh
 * OUT/.batch/journal-I-of-N.jsonl
 */
#ifndef VXM_BATCH_PLAN_H
#define VXM_BATCH_PLAN_H

#include "batch/supervisor.h"

#define BATCH_FOLDER ".batch"
/** Keys of settings that begin so are digests of files that options name. */
#define BATCH_FILE_OF "file of "

/**
 * Freezes the plan, or compares with the one that is there, which is renewed where inputs have changed and
 * the batch may go on with them (changes.h).
 *
 * @param plan what decides about the bytes of outputs: an object of texts
 * @param settings of the run; their folder of outputs is there
 * @return false with what has changed, where something has
 */
bool batch_plan_freeze(batch_manifest *manifest, const json_t *plan, const batch_settings *settings,
                       batch_error *error);
/** Writes the list of a plan anew. */
bool batch_plan_renew(const char *output, const batch_manifest *manifest, batch_error *error);
/**
 * A line of the list.
 *
 * @param with_path where a file lies is no part of what is compared: the same may be mounted elsewhere, or
 * named in another way
 */
json_t *batch_plan_line(const batch_item *item, bool with_path);

/** What was frozen: run.json, to be released; NULL after a failure. */
json_t *batch_plan_read(const char *output, batch_error *error);
/** Calls `each` with every line of the plan. */
bool batch_plan_each(const char *output, bool (*each)(const json_t *item, void *payload), void *payload,
                     batch_error *error);

/** "OUT/.batch/NAME", to be freed; NULL without memory. */
char *batch_plan_path(const char *output, const char *name);
/** "OUT/.batch/journal-I-of-N.jsonl", to be freed. */
char *batch_journal_path(const char *output, int shard, int shards);

/** Writes a whole file under a temporary name and renames it. */
bool batch_write_file(const char *path, const char *text, size_t size, batch_error *error);

#endif
