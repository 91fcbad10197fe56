/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/plan.h"
#include "batch/changes.h"
#include "batch/digest.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "voxmend.h"

static const char out_of_memory[] = "out of memory for the plan: free some";

char *batch_plan_path(const char *output, const char *name) {
  char *path = NULL;
  return asprintf(&path, "%s/" BATCH_FOLDER "%s%s", output, *name ? "/" : "", name) < 0 ? NULL : path;
}

char *batch_journal_path(const char *output, int shard, int shards) {
  char *path = NULL;
  int got = asprintf(&path, "%s/" BATCH_FOLDER "/journal-%d-of-%d.jsonl", output, shard, shards);
  return got < 0 ? NULL : path;
}

bool batch_write_file(const char *path, const char *text, size_t size, batch_error *error) {
  vxm_error failure = VXM_ERROR_INIT;
  if (vxm_file_write(NULL, path, text, size, &failure) == VXM_OK)
    return true;
  return batch_fail(error, "%s", failure.text);
}

/* ---- The list ---- */

static void set_text(json_t *object, const char *key, const char *text) {
  if (text)
    json_object_set_new(object, key, batch_json_string(text));
}

json_t *batch_plan_line(const batch_item *item, bool with_path) {
  json_t *object = json_object();
  set_text(object, "item", item->id);
  if (with_path)
    set_text(object, "path", item->path);
  if (with_path && item->is_misnamed)
    json_object_set_new(object, "misnamed", json_true());
  set_text(object, "member", item->member);
  set_text(object, "output", item->output);
  set_text(object, "class", item->kind);
  set_text(object, "split", item->split);
  set_text(object, "options", item->options);
  json_object_set_new(object, "bytes", json_integer((json_int_t)item->bytes));
  json_object_set_new(object, "modified", json_integer(item->modified));
  return object;
}

/** All lines, to be freed. */
static char *list_text(const batch_manifest *manifest, bool with_paths, size_t *size) {
  char *text = NULL;
  FILE *file = open_memstream(&text, size);
  bool good = file != NULL;
  for (int64_t i = 0; good && i < manifest->count; i++) {
    json_t *item = batch_plan_line(&manifest->items[i], with_paths);
    good = json_dumpf(item, file, JSON_COMPACT) == 0 && fputc('\n', file) != EOF;
    json_decref(item);
  }
  if (file && fclose(file) != 0)
    good = false;
  if (good)
    return text;
  free(text);
  return NULL;
}

/* ---- Reading ---- */

json_t *batch_plan_read(const char *output, batch_error *error) {
  char *path = batch_plan_path(output, "run.json");
  json_error_t problem;
  json_t *run = path ? json_load_file(path, 0, &problem) : NULL;
  if (!run && path && access(path, F_OK) != 0)
    batch_fail(error, "%s: there is no batch in this folder", output);
  else if (!run)
    batch_fail(error, "%s: the plan is damaged: %s", path ? path : output,
               path ? problem.text : out_of_memory);
  free(path);
  return run;
}

bool batch_plan_each(const char *output, bool (*each)(const json_t *item, void *payload), void *payload,
                     batch_error *error) {
  char *path = batch_plan_path(output, "plan.jsonl"), *line = NULL;
  FILE *file = path ? fopen(path, "re") : NULL;
  bool good = file || batch_fail_errno(error, "%s: cannot read the plan", path ? path : output);
  size_t room = 0;
  ssize_t length;
  while (good && (length = getline(&line, &room, file)) > 0) {
    json_t *item = json_loadb(line, (size_t)length, 0, NULL);
    good = item ? each(item, payload) : batch_fail(error, "%s: the plan is damaged", path);
    json_decref(item);
  }
  free(line);
  if (file)
    fclose(file);
  free(path);
  return good;
}

/* ---- Comparing ---- */

/** Digests of files that options name: batches before they were noted have none, and go on without. */
static bool is_digest(const char *key) {
  return strncmp(key, BATCH_FILE_OF, strlen(BATCH_FILE_OF)) == 0;
}

static bool same_settings(const char *output, const json_t *old, const json_t *now, batch_error *error) {
  const char *key;
  json_t *value;
  json_object_foreach((json_t *)(uintptr_t)now, key, value) {
    const char *before = batch_json_text(old, key), *after = json_string_value(value);
    if (!before && is_digest(key))
      continue;
    if (before && is_digest(key) && after && strcmp(before, after) != 0)
      return batch_fail(error,
                        "%s: the %s is another than when the batch began; give another -o, or the same",
                        output, key);
    if (strcmp(before ? before : "", after ? after : "") != 0)
      return batch_fail(error,
                        "%s: the batch began with %s '%s', now it is '%s'; give another -o, or the same",
                        output, key, before ? before : "", after ? after : "");
  }
  json_object_foreach((json_t *)(uintptr_t)old, key, value) {
    if (!json_object_get(now, key))
      return batch_fail(error, "%s: the batch began with other options; give another -o, or the same",
                        output);
  }
  return true;
}

static bool same_run(const json_t *run, const json_t *plan, const batch_settings *settings,
                     batch_error *error) {
  json_int_t before = json_integer_value(json_object_get(run, "shards"));
  if (!same_settings(settings->output, json_object_get(run, "settings"), plan, error))
    return false;
  return before == settings->shards ||
         batch_fail(error,
                    "%s: the batch began with --shard of %lld, now it is of %d; give another -o, or the same",
                    settings->output, (long long)before, settings->shards);
}

/* ---- Freezing ---- */

static json_t *run_json(const batch_manifest *manifest, const char *digest, const json_t *settings,
                        int shards) {
  char host[256] = "", date[32];
  time_t now = time(NULL);
  struct tm utc;
  gethostname(host, sizeof host - 1);
  strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  return json_pack("{s:s, s:s, s:o, s:i, s:I, s:s, s:O}", "voxmend", vxm_version(), "began", date, "host",
                   batch_json_string(host), "shards", shards, "items", (json_int_t)manifest->count,
                   "plan_sha256", digest, "settings", settings);
}

/** A file that is there from now on, unless another shard was first; then its stays. */
static bool create_once(const char *output, const char *name, const char *text, size_t size,
                        batch_error *error) {
  char temporary[64], *path = batch_plan_path(output, name);
  snprintf(temporary, sizeof temporary, "%s.%ld.tmp", name, (long)getpid());
  char *aside = batch_plan_path(output, temporary);
  bool good = path && aside ? true : batch_fail(error, out_of_memory);
  good = good && batch_write_file(aside, text, size, error);
  if (good && link(aside, path) != 0 && errno != EEXIST && rename(aside, path) != 0)
    good = batch_fail_errno(error, "%s: cannot write", path);
  if (aside)
    unlink(aside);
  free(aside);
  free(path);
  return good;
}

/** In one step. One that is there without a run.json is of a run that was ended before it began. */
static bool replace(const char *output, const char *name, const char *text, size_t size, batch_error *error) {
  char *path = batch_plan_path(output, name);
  bool good = path ? batch_write_file(path, text, size, error) : batch_fail(error, out_of_memory);
  free(path);
  return good;
}

static bool begin(const char *output, const batch_manifest *manifest, const char *digest,
                  const json_t *settings, int shards, batch_error *error) {
  size_t size = 0;
  char *list = list_text(manifest, true, &size);
  json_t *run = run_json(manifest, digest, settings, shards);
  char *text = run ? json_dumps(run, JSON_INDENT(2)) : NULL;
  char *folder = batch_plan_path(output, "");
  json_decref(run);
  bool good = list && text && folder ? true : batch_fail(error, out_of_memory);
  if (good && mkdir(folder, 0777) != 0 && errno != EEXIST)
    good = batch_fail_errno(error, "%s: cannot make the folder", folder);
  good = good && replace(output, "plan.jsonl", list, size, error);
  good = good && create_once(output, "run.json", text, strlen(text), error);
  free(folder);
  free(text);
  free(list);
  return good;
}

/** As the list is told without paths; false without memory. */
static bool digest_of(char out[BATCH_DIGEST], const batch_manifest *manifest, batch_error *error) {
  size_t size = 0;
  char *list = list_text(manifest, false, &size);
  if (list)
    batch_digest(out, list, size);
  free(list);
  return list || batch_fail(error, out_of_memory);
}

bool batch_plan_freeze(batch_manifest *manifest, const json_t *plan, const batch_settings *settings,
                       batch_error *error) {
  const char *output = settings->output;
  char digest[BATCH_DIGEST], *path = batch_plan_path(output, "run.json");
  bool good = path ? digest_of(digest, manifest, error) : batch_fail(error, out_of_memory);
  if (good && access(path, F_OK) != 0)
    good = begin(output, manifest, digest, plan, settings->shards, error);
  json_t *run = good ? batch_plan_read(output, error) : NULL;
  good = run && same_run(run, plan, settings, error);
  const char *before = batch_json_text(run, "plan_sha256");
  if (good && (!before || strcmp(before, digest) != 0))
    good = batch_changes_take(manifest, settings, error);
  json_decref(run);
  free(path);
  return good;
}

/** Ended between the two, the next run finds the list as it wants it, and renews the digest. */
bool batch_plan_renew(const char *output, const batch_manifest *manifest, batch_error *error) {
  size_t size = 0;
  char digest[BATCH_DIGEST], *list = list_text(manifest, true, &size), *text = NULL;
  json_t *run = batch_plan_read(output, error);
  bool good = run && digest_of(digest, manifest, error);
  if (good) {
    json_object_set_new(run, "plan_sha256", json_string(digest));
    text = json_dumps(run, JSON_INDENT(2));
    good = list && text ? replace(output, "plan.jsonl", list, size, error) &&
                              replace(output, "run.json", text, strlen(text), error)
                        : batch_fail(error, out_of_memory);
  }
  json_decref(run);
  free(text);
  free(list);
  return good;
}
