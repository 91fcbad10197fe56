/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/replay.h"
#include "batch/companions.h"
#include "batch/outputs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct replay {
  batch_manifest *manifest;
  batch_content *contents;
  const batch_settings *settings;
} replay;

const batch_content batch_no_content = {{0, 1}};

bool batch_content_read(batch_content *out, const char *digest) {
  return digest && sscanf(digest, "%16" SCNx64 "%16" SCNx64, &out->half[0], &out->half[1]) == 2;
}

static bool has_outputs(const char *output, const json_t *record) {
  const json_t *files = json_object_get(record, "outputs");
  for (size_t f = 0; f < json_array_size(files); f++)
    if (!batch_output_is_there(output, json_array_get(files, f)))
      return false;
  return true;
}

static void take_end(const replay *r, batch_item *item, const json_t *record) {
  batch_status status = batch_status_of(batch_json_text(record, "status"));
  item->aborted = 0;
  item->attempts = (uint8_t)(item->attempts < 255 ? item->attempts + 1 : 255);
  bool again = status == BATCH_STATUSES || r->settings->retry[status] ||
               (batch_is_done(status) && !has_outputs(r->settings->output, record));
  item->status = again ? BATCH_PENDING : status;
  item->refers_to_others = json_is_true(json_object_get(record, "refers_to_others"));
  item->is_other_beside = !again && !batch_companions_same(item->path, json_object_get(record, "companions"));
}

/** It is another file from then on. */
static void take_change(const replay *r, int64_t at) {
  r->manifest->items[at].status = BATCH_PENDING;
  r->manifest->items[at].aborted = 0;
  r->manifest->items[at].refers_to_others = r->manifest->items[at].is_other_beside = false;
  r->contents[at] = (batch_content){{0, 0}};
}

static bool take(json_t *record, void *payload) {
  const replay *r = payload;
  const char *event = batch_json_text(record, "event");
  int64_t at = batch_manifest_find(r->manifest, batch_json_text(record, "item"));
  if (at < 0 || !event)
    return true;
  batch_item *item = &r->manifest->items[at];
  if (strcmp(event, "start") == 0) {
    /* A run that was ended while many were at work tells nothing about any of them. */
    if (json_is_true(json_object_get(record, "alone")))
      item->aborted = (uint8_t)(item->aborted < 255 ? item->aborted + 1 : 255);
    else if (item->aborted == 0)
      item->aborted = 1;
  } else if (strcmp(event, "lost") == 0) {
    if (item->aborted > 1)
      item->aborted--;
  } else if (strcmp(event, "end") == 0)
    take_end(r, item, record);
  else if (strcmp(event, "changed") == 0)
    take_change(r, at);
  if (strcmp(event, "end") == 0 || strcmp(event, "hash") == 0)
    batch_content_read(&r->contents[at], batch_json_text(record, "sha256"));
  return true;
}

bool batch_replay(batch_manifest *manifest, batch_content *contents, const batch_settings *settings,
                  const char *journal, batch_error *error) {
  replay r = {manifest, contents, settings};
  return access(journal, F_OK) != 0 || batch_journal_read(journal, take, &r, NULL, error);
}
