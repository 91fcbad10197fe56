/* SPDX-License-Identifier: BSD-3-Clause */
/** From how a child ended to a record in the journal. */
#include "batch/outputs.h"
#include "batch/run.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

bool batch_end_item(run *r, int64_t index, batch_status status, json_t *record) {
  batch_item *item = &r->manifest->items[index];
  if (!record)
    record = json_object();
  json_object_set_new(record, "event", json_string("end"));
  json_object_set_new(record, "item", batch_json_string(item->id));
  json_object_set_new(record, "status", json_string(batch_status_names[status]));
  json_object_set_new(record, "attempt", json_integer(item->attempts + 1));
  if (!batch_is_done(status)) { /* what it had made before it failed */
    json_object_del(record, "outputs");
    json_t *job = r->settings->job(item, 0, r->settings->payload, &(batch_error){""});
    json_t *outputs = json_object_get(job, "outputs"), *name;
    size_t o;
    json_array_foreach(outputs, o, name) batch_output_remove(r->settings->output, json_string_value(name));
    json_decref(job);
  }
  if (!batch_journal_add(&r->journal, record, r->error))
    return batch_break(r);
  item->attempts = (uint8_t)(item->attempts < 255 ? item->attempts + 1 : 255);
  item->aborted = 0;
  item->status = status;
  r->tally->counts[BATCH_PENDING]--;
  r->tally->counts[status]++;
  r->tally->fresh++;
  return true;
}

/* ---- What went wrong ---- */

/** The last line that it printed, without the program's name. */
static const char *last_line(char *text) {
  size_t length = strlen(text);
  while (length > 0 && (text[length - 1] == '\n' || text[length - 1] == '\r'))
    text[--length] = '\0';
  char *line = strrchr(text, '\n');
  line = line ? line + 1 : text;
  return strncmp(line, "voxmend: ", 9) == 0 ? line + 9 : line;
}

static void set_message(json_t *record, const char *text) {
  json_object_set_new(record, "message", batch_json_string(text));
}

/** The status, and message, of a child that did not end as it should. */
static batch_status judge(json_t *record, const batch_ending *ending, const batch_settings *settings) {
  char text[256];
  int status = ending->wait_status;
  if (ending->reason == BATCH_REASON_TIMEOUT) {
    snprintf(text, sizeof text, "not done after %g s (--time-limit)", settings->limits.seconds);
    set_message(record, text);
    return BATCH_TIMEOUT;
  }
  if (ending->reason == BATCH_REASON_FLOOD) {
    set_message(record, "it did not cease to print");
    return BATCH_FAILED;
  }
  if (WIFSIGNALED(status)) {
    int number = WTERMSIG(status);
    bool is_oom = number == SIGKILL; /* not by us: then it is the kernel, in want of memory */
    json_object_set_new(record, "signal", json_integer(number));
    snprintf(text, sizeof text, is_oom ? "ended by the system, as memory ran out" : "crashed: %s",
             strsignal(number));
    set_message(record, text);
    return is_oom ? BATCH_OOM : BATCH_CRASH;
  }
  snprintf(text, sizeof text, "ended with status %d without a result", WEXITSTATUS(status));
  set_message(record, text);
  return BATCH_CRASH;
}

static void add_costs(json_t *record, const batch_ending *ending) {
  json_object_set_new(record, "wall_ms", json_real((double)(int64_t)(ending->wall_ms * 1000) / 1000));
  json_object_set_new(record, "cpu_ms", json_real((double)(int64_t)(ending->cpu_ms * 1000) / 1000));
  json_object_set_new(record, "peak_bytes", json_integer((json_int_t)ending->peak_bytes));
}

void batch_take_hash(run *r, int64_t item, const char *digest) {
  if (!batch_content_read(&r->contents[item], digest)) {
    r->contents[item] = batch_no_content;
    return;
  }
  json_t *record = json_pack("{s:s, s:o, s:s}", "event", "hash", "item",
                             batch_json_string(r->manifest->items[item].id), "sha256", digest);
  if (!batch_journal_add(&r->journal, record, r->error))
    batch_break(r);
}

static void take_hashes(run *r, const batch_slot *slot, const json_t *result) {
  const json_t *digests = json_object_get(result, "hash");
  for (int i = 0; i < slot->count && !r->is_broken; i++) {
    const char *digest = json_string_value(json_array_get(digests, (size_t)i));
    if (digest) /* else the child did not come so far */
      batch_take_hash(r, slot->items[i], digest);
  }
}

/**
 * Who ran out of what all had to share may not when it is alone. Who was killed from outside may have been
 * chosen by chance, even twice.
 */
static bool may_try_again(const run *r, const batch_slot *slot, bool was_killed) {
  enum { KILLS_MAX = 3 };
  batch_item *item = &r->manifest->items[slot->items[0]];
  if (was_killed)
    return ++item->kills < KILLS_MAX;
  return !slot->is_alone && r->settings->alone_memory;
}

static void take_work(run *r, const batch_slot *slot, const batch_ending *ending, json_t *result) {
  int64_t item = slot->items[0];
  bool was_orderly = ending->reason == BATCH_REASON_ENDED && WIFEXITED(ending->wait_status);
  batch_status status = was_orderly ? batch_status_of(batch_json_text(result, "status")) : BATCH_STATUSES;
  json_t *record = status < BATCH_STATUSES ? json_incref(result) : json_object();
  if (json_is_true(json_object_get(record, "disk_full"))) {
    json_decref(record);
    batch_fail(r->error, "%s: no room is left on the disk; make room, and the same command goes on",
               r->settings->output);
    batch_break(r);
    return;
  }
  bool is_told = status < BATCH_STATUSES && (batch_is_done(status) || batch_json_text(record, "message"));
  char *said = is_told ? NULL : strdup(ending->message);
  const char *key = status < BATCH_STATUSES ? "message" : "last_words";
  if (status == BATCH_STATUSES)
    status = judge(record, ending, r->settings);
  if (said && *last_line(said))
    json_object_set_new(record, key, batch_json_string(last_line(said)));
  free(said);
  add_costs(record, ending);
  if (status == BATCH_OOM && may_try_again(r, slot, !was_orderly)) {
    r->needs_more[item] = true; /* once more when nobody else is at work */
    json_decref(record);
    return;
  }
  batch_end_item(r, item, status, record);
}

void batch_take_ending(run *r, batch_slot *slot, const batch_ending *ending) {
  json_t *result = json_loads(ending->result, 0, NULL);
  if (result && !json_is_object(result)) {
    json_decref(result);
    result = NULL;
  }
  if (slot->is_hashing)
    take_hashes(r, slot, result);
  else
    take_work(r, slot, ending, result);
  json_decref(result);
}
