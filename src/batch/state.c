/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/state.h"
#include "batch/journal.h"
#include "batch/plan.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- The plan ---- */

typedef struct adding {
  batch_manifest *manifest;
  batch_error *error;
} adding;

/** The output's name is taken as it stands there; the number is that of the line. */
static bool add_item(const json_t *line, void *payload) {
  const adding *a = payload;
  batch_item item = {.id = (char *)(uintptr_t)batch_json_text(line, "item"),
                     .path = (char *)(uintptr_t)batch_json_text(line, "path"),
                     .member = (char *)(uintptr_t)batch_json_text(line, "member"),
                     .kind = (char *)(uintptr_t)batch_json_text(line, "class"),
                     .split = (char *)(uintptr_t)batch_json_text(line, "split"),
                     .options = (char *)(uintptr_t)batch_json_text(line, "options"),
                     .bytes = (uint64_t)json_integer_value(json_object_get(line, "bytes"))};
  const char *output = batch_json_text(line, "output");
  if (!item.id || !item.path || !output)
    return batch_fail(a->error, "the plan is damaged: a line lacks its item");
  if (!batch_manifest_add(a->manifest, &item, a->error))
    return false;
  batch_item *added = &a->manifest->items[a->manifest->count - 1];
  added->number = a->manifest->count - 1;
  added->output = strdup(output);
  added->is_misnamed = json_is_true(json_object_get(line, "misnamed"));
  return added->output || batch_fail(a->error, "out of memory: free some");
}

/* ---- Journals ---- */

static double number(const json_t *object, const char *key) {
  return json_number_value(json_object_get(object, key));
}

static uint64_t bytes_of(const json_t *files) {
  uint64_t bytes = 0;
  for (size_t f = 0; f < json_array_size(files); f++)
    bytes += (uint64_t)json_integer_value(json_object_get(json_array_get(files, f), "bytes"));
  return bytes;
}

static double voxels_of(const json_t *grid) {
  const json_t *dims = json_object_get(grid, "dims");
  double count = json_array_size(dims) == 3 ? 1 : 0;
  for (size_t d = 0; d < json_array_size(dims); d++)
    count *= json_number_value(json_array_get(dims, d));
  return count;
}

static void take_numbers(batch_end *end, const json_t *record) {
  const json_t *grid = json_object_get(record, "voxelize");
  double voxels = voxels_of(json_object_get(grid, "grid"));
  end->wall_ms = (float)number(record, "wall_ms");
  end->cpu_ms = (float)number(record, "cpu_ms");
  end->peak_bytes = (uint64_t)number(record, "peak_bytes");
  end->output_bytes = bytes_of(json_object_get(record, "outputs"));
  end->warnings = (uint32_t)json_array_size(json_object_get(record, "warnings"));
  end->contested = voxels > 0 ? (float)(number(json_object_get(grid, "votes"), "contested") / voxels) : 0;
  end->thin = (float)number(json_object_get(grid, "thin"), "share");
}

static void free_end(batch_end *end) {
  free(end->stage);
  free(end->message);
  *end = (batch_end){0};
}

static void take_texts(batch_end *end, const json_t *record) {
  const char *stage = batch_json_text(record, "stage"), *message = batch_json_text(record, "message");
  if (!message)
    message = batch_json_text(record, "last_words");
  if (!message)
    message = json_string_value(json_array_get(json_object_get(record, "warnings"), 0));
  end->stage = stage ? strdup(stage) : NULL;
  end->message = message ? strdup(message) : NULL;
}

typedef struct reading {
  batch_state *state;
  bool is_complete;
} reading;

static bool take(json_t *record, void *payload) {
  reading *r = payload;
  const char *event = batch_json_text(record, "event");
  if (!event)
    return true;
  bool is_complete = strcmp(event, "complete") == 0, is_end = strcmp(event, "end") == 0;
  bool is_changed = strcmp(event, "changed") == 0; /* to be done, with the rest as in an end */
  if (strcmp(event, "begin") == 0 || is_complete || is_changed)
    r->is_complete = is_complete;
  int64_t at =
      is_end || is_changed ? batch_manifest_find(&r->state->manifest, batch_json_text(record, "item")) : -1;
  batch_status status = batch_status_of(batch_json_text(record, "status"));
  if (at < 0 || status == BATCH_STATUSES)
    return true;
  batch_end *end = &r->state->ends[at];
  free_end(end);
  r->state->records += is_end;
  take_numbers(end, record);
  take_texts(end, record);
  r->state->manifest.items[at].status = status;
  return true;
}

static bool read_journals(batch_state *state, const char *output, batch_error *error) {
  bool good = true;
  for (int s = 0; good && s < state->shards; s++) {
    char *path = batch_journal_path(output, s, state->shards);
    reading r = {.state = state};
    int64_t damaged = 0;
    if (path && access(path, F_OK) == 0)
      good = batch_journal_read(path, take, &r, &damaged, error);
    state->damaged += damaged;
    state->complete += r.is_complete;
    free(path);
  }
  return good;
}

/* ---- State ---- */

bool batch_state_read(batch_state *out, const char *output, batch_error *error) {
  *out = (batch_state){0};
  adding a = {&out->manifest, error};
  out->run = batch_plan_read(output, error);
  if (!out->run)
    return false;
  out->shards = (int)json_integer_value(json_object_get(out->run, "shards"));
  bool good = out->shards >= 1 && out->shards <= 1000000
                  ? batch_plan_each(output, add_item, &a, error)
                  : batch_fail(error, "%s: the plan is damaged: no number of shards", output);
  if (good) {
    out->ends = calloc((size_t)out->manifest.count + 1, sizeof *out->ends);
    good = out->ends ? read_journals(out, output, error) : batch_fail(error, "out of memory: free some");
  }
  if (!good)
    batch_state_free(out);
  return good;
}

void batch_state_count(const batch_state *state, int64_t counts[BATCH_STATUSES]) {
  memset(counts, 0, BATCH_STATUSES * sizeof *counts);
  for (int64_t i = 0; i < state->manifest.count; i++)
    counts[state->manifest.items[i].status]++;
}

void batch_state_free(batch_state *state) {
  for (int64_t i = 0; state->ends && i < state->manifest.count; i++)
    free_end(&state->ends[i]);
  free(state->ends);
  batch_manifest_free(&state->manifest);
  json_decref(state->run);
  *state = (batch_state){0};
}
