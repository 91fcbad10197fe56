/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/changes.h"
#include "batch/digest.h"
#include "batch/placement.h"
#include "batch/plan.h"
#include "batch/replay.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** How a file is not the one of the plan. */
typedef enum change { SAME = 0, OTHER_TIME, OTHER_SIZE } change;

/** Changes with which no batch goes on. */
enum { ADDED, REMOVED, OTHERWISE, KINDS };

typedef struct comparison {
  const batch_manifest *manifest;
  uint8_t *changes; /**< of each item */
  int64_t next, counts[KINDS];
  char first[KINDS][128];
} comparison;

/* ---- Comparing with the plan: both lists are in the order of ids ---- */

static void note(comparison *c, int kind, const char *id) {
  if (c->counts[kind]++ == 0)
    snprintf(c->first[kind], sizeof c->first[kind], "%s", id);
}

static bool is_told_alike(const batch_item *item, const json_t *old) {
  static const char *const of_file[] = {"path", "misnamed", "bytes", "modified"};
  json_t *now = batch_plan_line(item, false), *before = json_copy((json_t *)(uintptr_t)old);
  for (size_t k = 0; k < sizeof of_file / sizeof *of_file; k++) {
    json_object_del(now, of_file[k]);
    json_object_del(before, of_file[k]);
  }
  const char *split = batch_json_text(old, "split"),
             *named = split ? batch_split_named(split, strlen(split)) : NULL;
  if (named) /* "Test" and "validation" in plans of before */
    json_object_set_new(before, "split", json_string(named));
  bool alike = json_equal(now, before);
  json_decref(now);
  json_decref(before);
  return alike;
}

static change change_of(const batch_item *item, const json_t *old) {
  if (json_integer_value(json_object_get(old, "bytes")) != (json_int_t)item->bytes)
    return OTHER_SIZE;
  return json_integer_value(json_object_get(old, "modified")) == item->modified ? SAME : OTHER_TIME;
}

static bool compare_line(const json_t *old, void *payload) {
  comparison *c = payload;
  const char *id = batch_json_text(old, "item");
  const batch_manifest *m = c->manifest;
  for (; id && c->next < m->count && strcmp(m->items[c->next].id, id) < 0; c->next++)
    note(c, ADDED, m->items[c->next].id);
  if (!id || c->next == m->count || strcmp(m->items[c->next].id, id) != 0) {
    note(c, REMOVED, id ? id : "?");
    return true;
  }
  const batch_item *item = &m->items[c->next];
  c->changes[c->next++] = (uint8_t)change_of(item, old);
  if (!is_told_alike(item, old))
    note(c, OTHERWISE, id);
  return true;
}

static bool tell_other_inputs(const comparison *c, const char *output, batch_error *error) {
  static const char *const what[] = {"new", "gone", "with another class, split, output or options"};
  char list[700] = "";
  size_t used = 0;
  for (int k = 0; k < KINDS; k++)
    if (c->counts[k] > 0)
      used +=
          (size_t)snprintf(list + used, sizeof list - used, "%s %lld %s (%s%s)", used ? "," : "",
                           (long long)c->counts[k], what[k], c->first[k], c->counts[k] > 1 ? ", ..." : "");
  return batch_fail(error,
                    "%s: the inputs are not those that the batch began with:%s; undo that, or give another "
                    "-o%s",
                    output, list, c->counts[ADDED] > 0 ? ", to which new ones alone may go, too" : "");
}

static bool compare(comparison *c, const char *output, batch_error *error) {
  if (!batch_plan_each(output, compare_line, c, error))
    return false;
  for (; c->next < c->manifest->count; c->next++)
    note(c, ADDED, c->manifest->items[c->next].id);
  for (int k = 0; k < KINDS; k++)
    if (c->counts[k] > 0)
      return tell_other_inputs(c, output, error);
  return true;
}

/* ---- Judging files that have changed ---- */

static bool replay_all(batch_manifest *manifest, batch_content *contents, const batch_settings *settings,
                       batch_error *error) {
  bool good = true;
  for (int s = 0; good && s < settings->shards; s++) {
    char *journal = batch_journal_path(settings->output, s, settings->shards);
    good = journal ? batch_replay(manifest, contents, settings, journal, error)
                   : batch_fail(error, "out of memory: free some");
    free(journal);
  }
  return good;
}

/** Members of archives are not unpacked for that. */
static bool has_content(const batch_item *item, const batch_content *known) {
  char digest[BATCH_DIGEST];
  uint64_t bytes;
  batch_content now;
  return known->half[0] && !item->member && batch_digest_file(digest, &bytes, item->path) &&
         batch_content_read(&now, digest) && memcmp(&now, known, sizeof now) == 0;
}

/** Files that have changed although they must not: their items have a status that the batch keeps, or other
 * processes may be working on them. */
typedef struct refusal {
  int64_t count;
  const batch_item *first;
  bool statuses[BATCH_STATUSES];
} refusal;

static void refuse(refusal *r, const batch_item *item) {
  if (r->count++ == 0)
    r->first = item;
  r->statuses[item->status] = true;
}

/** "add --retry unreadable,failed, and remove ...," */
static void what_helps(char out[256], const refusal *r, int shards) {
  size_t used = 0;
  if (shards > 1) {
    snprintf(out, 256, "with --shard none is done anew;");
    return;
  }
  for (int s = BATCH_DEGRADED; s < BATCH_STATUSES; s++)
    if (r->statuses[s] && s != BATCH_DUPLICATE)
      used += (size_t)snprintf(out + used, 256 - used, "%s%s", used ? "," : "add --retry ",
                               batch_status_names[s]);
  if (r->statuses[BATCH_OK] || r->statuses[BATCH_DUPLICATE])
    used += (size_t)snprintf(out + used, 256 - used, "%sremove the outputs of those ok or duplicate",
                             used ? ", and " : "");
  snprintf(out + used, 256 - used, ",");
}

/** @param beside whether it is files that were read beside the inputs */
static bool tell_refusal(const refusal *r, bool beside, const batch_settings *settings, batch_error *error) {
  char help[256];
  what_helps(help, r, settings->shards);
  return batch_fail(
      error,
      "%s: %s%lld of the inputs%s changed after the batch began (%s, %s%s): %s undo that, or give "
      "another -o",
      settings->output, beside ? "files beside " : "", (long long)r->count,
      beside ? " (buffers, materials, textures)" : "", r->first->id, batch_status_names[r->first->status],
      r->count > 1 ? ", ..." : "", help);
}

bool batch_changes_beside(const batch_manifest *manifest, const batch_settings *settings,
                          batch_error *error) {
  refusal r = {0};
  for (int64_t i = 0; i < manifest->count; i++)
    if (manifest->items[i].is_other_beside)
      refuse(&r, &manifest->items[i]);
  return r.count == 0 || tell_refusal(&r, true, settings, error);
}

/** Leaves as changed what is to be made anew. With shards it is not known who is at what just now. */
static bool judge(comparison *c, const batch_content *contents, const batch_settings *settings,
                  batch_error *error) {
  refusal r = {0};
  for (int64_t i = 0; i < c->manifest->count; i++) {
    const batch_item *item = &c->manifest->items[i];
    bool is_due = settings->shards == 1 && item->status == BATCH_PENDING;
    if (c->changes[i] == SAME || is_due)
      continue;
    if (c->changes[i] == OTHER_TIME && has_content(item, &contents[i]))
      c->changes[i] = SAME;
    else
      refuse(&r, item);
  }
  return r.count == 0 || tell_refusal(&r, false, settings, error);
}

static int by_content(const void *a, const void *b) {
  return memcmp(a, b, sizeof(batch_content));
}

/** What had the bytes of a file that has changed is no duplicate of it any more, and is to be done for
 * itself.
 */
static bool take_duplicates(comparison *c, const batch_content *contents, batch_error *error) {
  int64_t count = c->manifest->count, known = 0;
  batch_content *before = malloc((size_t)(count + 1) * sizeof *before);
  for (int64_t i = 0; before && i < count; i++)
    if (c->changes[i] != SAME && contents[i].half[0])
      before[known++] = contents[i];
  if (before)
    qsort(before, (size_t)known, sizeof *before, by_content);
  for (int64_t i = 0; before && i < count; i++)
    if (c->manifest->items[i].status == BATCH_DUPLICATE &&
        bsearch(&contents[i], before, (size_t)known, sizeof *before, by_content))
      c->changes[i] = OTHER_TIME;
  free(before);
  return before || batch_fail(error, "out of memory: free some");
}

/* ---- Renewing ---- */

/** First the journal, which then knows no status and no content of it: ended behind that, the next run comes
 * to the same judgement. */
static bool note_changes(batch_journal *journal, const comparison *c, batch_error *error) {
  bool good = true;
  for (int64_t i = 0; good && i < c->manifest->count; i++)
    if (c->changes[i] != SAME)
      good = batch_journal_add(journal,
                               json_pack("{s:s, s:o, s:s}", "event", "changed", "item",
                                         batch_json_string(c->manifest->items[i].id), "status",
                                         batch_status_names[BATCH_PENDING]),
                               error);
  return good && batch_journal_sync(journal, error);
}

static bool judge_all(comparison *c, batch_manifest *manifest, const batch_settings *settings,
                      batch_error *error) {
  batch_content *contents = calloc((size_t)manifest->count + 1, sizeof *contents);
  bool good = contents || batch_fail(error, "out of memory: free some");
  good = good && replay_all(manifest, contents, settings, error) && judge(c, contents, settings, error) &&
         take_duplicates(c, contents, error);
  for (int64_t i = 0; i < manifest->count; i++) { /* as the run replays its journal, too */
    batch_item *item = &manifest->items[i];
    item->status = BATCH_PENDING;
    item->attempts = item->aborted = 0;
    item->refers_to_others = item->is_other_beside = false;
  }
  free(contents);
  return good;
}

/** With the journal locked, lest another run be at work with the plan as it was. */
static bool renew(comparison *c, batch_manifest *manifest, const batch_settings *settings,
                  batch_error *error) {
  batch_journal journal;
  char *path = batch_journal_path(settings->output, 0, 1);
  int folder = open(settings->output, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  bool good = path && folder >= 0 ? batch_journal_open(&journal, path, folder, error)
                                  : batch_fail_errno(error, "%s: cannot open the folder", settings->output);
  if (good) {
    good = judge_all(c, manifest, settings, error) && note_changes(&journal, c, error) &&
           batch_plan_renew(settings->output, manifest, error);
    batch_journal_close(&journal);
  }
  if (folder >= 0)
    close(folder);
  free(path);
  return good;
}

/** Where one shard wrote the list, and another, of other inputs, run.json. */
static bool tell_two_beginnings(const char *output, batch_error *error) {
  return batch_fail(error, "%s: two batches with different inputs began there at once; give another -o",
                    output);
}

/** With shards the plan stays as it is: it is all of them that would have to agree. */
static bool judge_shards(comparison *c, batch_manifest *manifest, const batch_settings *settings,
                         batch_error *error) {
  size_t count = (size_t)manifest->count;
  bool has_change = memchr(c->changes, OTHER_TIME, count) || memchr(c->changes, OTHER_SIZE, count);
  batch_settings kept = *settings; /* nothing is due */
  memset(kept.retry, 0, sizeof kept.retry);
  return has_change ? judge_all(c, manifest, &kept, error) : tell_two_beginnings(settings->output, error);
}

bool batch_changes_take(batch_manifest *manifest, const batch_settings *settings, batch_error *error) {
  comparison c = {.manifest = manifest, .changes = calloc((size_t)manifest->count + 1, 1)};
  bool good = c.changes || batch_fail(error, "out of memory: free some");
  good = good && compare(&c, settings->output, error) &&
         (settings->shards == 1 ? renew(&c, manifest, settings, error)
                                : judge_shards(&c, manifest, settings, error));
  free(c.changes);
  return good;
}
