/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/verify.h"
#include "batch/journal.h"
#include "batch/outputs.h"
#include "batch/plan.h"
#include "batch/state.h"
#include "batch/tree.h"

#include <errno.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct verifying {
  batch_verification *found;
  const char *output;
  void (*tell)(const char *line, void *payload);
  void *payload;
  const batch_manifest *manifest;
  int64_t *last; /**< of each item: number of the record that is its last end; -1 = none */
  int64_t number;
} verifying;

static void report(const verifying *v, int64_t *count, const char *name, const char *what) {
  char *line = NULL;
  (*count)++;
  if (asprintf(&line, "%s/%s: %s", v->output, name, what) >= 0)
    v->tell(line, v->payload);
  free(line);
}

static void verify_file(const verifying *v, const json_t *file) {
  const char *name = batch_json_text(file, "path"), *digest = batch_json_text(file, "sha256");
  if (!name || !digest)
    return;
  json_t *now = batch_output_describe(v->output, name);
  const char *found = batch_json_text(now, "sha256");
  v->found->files++;
  if (!found)
    report(v, &v->found->missing, name, errno == ENOENT ? "is missing" : strerror(errno));
  else if (strcmp(found, digest) != 0)
    report(v, &v->found->changed, name, "is not what was written");
  json_decref(now);
}

static int64_t item_of(const verifying *v, const json_t *record) {
  const char *event = batch_json_text(record, "event");
  return event && (strcmp(event, "end") == 0 || strcmp(event, "changed") == 0)
             ? batch_manifest_find(v->manifest, batch_json_text(record, "item"))
             : -1;
}

/** A mesh may have been done again: only its last end counts. */
static bool find_last(json_t *record, void *payload) {
  verifying *v = payload;
  int64_t item = item_of(v, record);
  v->number++;
  if (item >= 0)
    v->last[item] = v->number;
  return true;
}

static bool verify_last(json_t *record, void *payload) {
  verifying *v = payload;
  int64_t item = item_of(v, record);
  v->number++;
  if (item < 0 || v->last[item] != v->number)
    return true;
  const json_t *files = json_object_get(record, "outputs");
  for (size_t f = 0; f < json_array_size(files); f++)
    verify_file(v, json_array_get(files, f));
  return true;
}

static bool verify_journals(verifying *v, int shards, batch_error *error) {
  bool good = true;
  for (int s = 0; good && s < shards; s++) {
    char *path = batch_journal_path(v->output, s, shards);
    if (path && access(path, F_OK) == 0) {
      v->number = 0;
      good = batch_journal_read(path, find_last, v, NULL, error);
      v->number = 0;
      good = good && batch_journal_read(path, verify_last, v, NULL, error);
    }
    free(path);
  }
  return good;
}

/** What a killed process may leave between two steps; the next that writes there takes it away. */
static batch_tree_step find_stranger(const batch_tree_entry *entry, void *payload) {
  const verifying *v = payload;
  if (entry->kind == BATCH_TREE_FILE && fnmatch("voxmend-*-*.tmp", entry->name, 0) == 0)
    report(v, &v->found->strangers, entry->path + strlen(v->output) + 1,
           "was left behind by a run that was ended");
  return BATCH_TREE_ON;
}

bool batch_verify(batch_verification *out, const char *output, void (*tell)(const char *line, void *payload),
                  void *payload, batch_error *error) {
  batch_state state;
  int64_t counts[BATCH_STATUSES];
  *out = (batch_verification){0};
  if (!batch_state_read(&state, output, error))
    return false;
  verifying v = {
      .found = out, .output = output, .tell = tell, .payload = payload, .manifest = &state.manifest};
  v.last = calloc((size_t)state.manifest.count + 1, sizeof *v.last);
  bool good =
      v.last ? verify_journals(&v, state.shards, error) : batch_fail(error, "out of memory: free some");
  batch_tree_walk(output, false, find_stranger, &v);
  batch_state_count(&state, counts);
  out->unfinished = counts[BATCH_PENDING];
  out->damaged = state.damaged;
  free(v.last);
  batch_state_free(&state);
  return good;
}
