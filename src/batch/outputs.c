/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/outputs.h"
#include "batch/digest.h"
#include "batch/tree.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char *path_of(const char *output, const char *name) {
  char *path = NULL;
  return name && asprintf(&path, "%s/%s", output, name) >= 0 ? path : NULL;
}

/* ---- Describing ---- */

static int by_name(const struct dirent **a, const struct dirent **b) {
  return strcmp((*a)->d_name, (*b)->d_name);
}

static int is_shown(const struct dirent *entry) {
  return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0; /* .zarray is a part */
}

static bool is_directory(const char *path) {
  struct stat info;
  return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static bool digest_any(char out[BATCH_DIGEST], int64_t *files, uint64_t *bytes, const char *path);

/** Digest of the lines "NAME DIGEST" of all that is in it; false with errno. */
static bool digest_folder(char out[BATCH_DIGEST], int64_t *files, uint64_t *bytes, const char *path) {
  struct dirent **entries = NULL;
  char *text = NULL;
  size_t size = 0;
  int count = scandir(path, &entries, is_shown, by_name);
  FILE *list = count >= 0 ? open_memstream(&text, &size) : NULL;
  bool good = list != NULL;
  int reason = errno;
  for (int e = 0; e < count; e++) {
    char digest[BATCH_DIGEST], *inner = good ? path_of(path, entries[e]->d_name) : NULL;
    if (inner && digest_any(digest, files, bytes, inner))
      fprintf(list, "%s %s\n", entries[e]->d_name, digest);
    else if (good) {
      good = false;
      reason = errno;
    }
    free(inner);
    free(entries[e]);
  }
  free(entries);
  if (list && fclose(list) != 0 && good) {
    good = false;
    reason = errno;
  }
  if (good)
    batch_digest(out, text, strlen(text));
  free(text);
  errno = reason;
  return good;
}

/** Digest of a file or folder, whose files and bytes are added. */
static bool digest_any(char out[BATCH_DIGEST], int64_t *files, uint64_t *bytes, const char *path) {
  if (is_directory(path))
    return digest_folder(out, files, bytes, path);
  uint64_t length = 0;
  bool good = batch_digest_file(out, &length, path);
  *files += good;
  *bytes += length;
  return good;
}

json_t *batch_output_describe(const char *output, const char *name) {
  char digest[BATCH_DIGEST], *path = path_of(output, name);
  int64_t files = 0;
  uint64_t bytes = 0;
  json_t *described = NULL;
  bool folder = path && is_directory(path);
  if (folder && digest_folder(digest, &files, &bytes, path))
    described = json_pack("{s:o, s:I, s:I, s:s}", "path", batch_json_string(name), "files", (json_int_t)files,
                          "bytes", (json_int_t)bytes, "sha256", digest);
  else if (path && !folder && batch_digest_file(digest, &bytes, path))
    described = json_pack("{s:o, s:I, s:s}", "path", batch_json_string(name), "bytes", (json_int_t)bytes,
                          "sha256", digest);
  int reason = errno;
  free(path);
  errno = reason;
  return described;
}

bool batch_output_is_there(const char *output, const json_t *described) {
  char *path = path_of(output, batch_json_text(described, "path"));
  struct stat info;
  bool is_folder = json_object_get(described, "files") != NULL;
  bool good = path && stat(path, &info) == 0 &&
              (is_folder ? S_ISDIR(info.st_mode)
                         : S_ISREG(info.st_mode) &&
                               info.st_size == json_integer_value(json_object_get(described, "bytes")));
  free(path);
  return good;
}

/* ---- Removing ---- */

static batch_tree_step remove_entry(const batch_tree_entry *entry, void *payload) {
  (void)payload;
  if (entry->kind == BATCH_TREE_LEFT || entry->kind == BATCH_TREE_CLOSED)
    rmdir(entry->path);
  else if (entry->kind != BATCH_TREE_FOLDER)
    unlink(entry->path);
  return BATCH_TREE_ON;
}

void batch_folder_remove(const char *path) {
  batch_tree_walk(path, false, remove_entry, NULL);
}

void batch_output_remove(const char *output, const char *name) {
  static const char *const ends[] = {"", ".json"};
  for (int e = 0; e < 2; e++) {
    char *path = path_of(output, name), *whole = NULL;
    if (path && asprintf(&whole, "%s%s", path, ends[e]) >= 0 && unlink(whole) != 0 &&
        (errno == EISDIR || errno == EPERM) && e == 0)
      batch_folder_remove(whole);
    free(whole);
    free(path);
  }
}

/* ---- Checking ---- */

/** A file, by what the system knows it. */
typedef struct known_file {
  dev_t device;
  ino_t number;
} known_file;

static int by_file(const void *a, const void *b) {
  const known_file *x = a, *y = b;
  if (x->device != y->device)
    return x->device < y->device ? -1 : 1;
  return (x->number > y->number) - (x->number < y->number);
}

/** A name, by its digest: names of a million outputs are not held. */
typedef struct named {
  uint64_t key;
  int64_t item;
} named;

static int by_key(const void *a, const void *b) {
  const named *x = a, *y = b;
  if (x->key != y->key)
    return x->key < y->key ? -1 : 1;
  return (x->item > y->item) - (x->item < y->item);
}

typedef struct checking {
  const batch_manifest *manifest;
  const batch_settings *settings;
  known_file *inputs;
  named *names;
  size_t name_count, name_capacity;
} checking;

static bool note_name(checking *c, const char *name, int64_t item) {
  if (c->name_count == c->name_capacity) {
    size_t room = c->name_capacity ? 2 * c->name_capacity : 1024;
    named *grown = realloc(c->names, room * sizeof *grown);
    if (!grown)
      return false;
    c->names = grown;
    c->name_capacity = room;
  }
  char digest[BATCH_DIGEST];
  named *n = &c->names[c->name_count++];
  batch_digest(digest, name, strlen(name));
  digest[16] = '\0';
  *n = (named){strtoull(digest, NULL, 16), item};
  return true;
}

/** Whether the file that has the name of an output is one that is read. */
static bool is_input(const checking *c, const char *name) {
  char *path = path_of(c->settings->output, name);
  struct stat info;
  bool is_there = path && stat(path, &info) == 0;
  free(path);
  known_file key = {info.st_dev, info.st_ino};
  return is_there && bsearch(&key, c->inputs, (size_t)c->manifest->count, sizeof key, by_file);
}

static bool check_item(checking *c, int64_t i, batch_error *error) {
  const batch_item *item = &c->manifest->items[i];
  json_t *job = c->settings->job(item, 0, c->settings->payload, error), *name;
  size_t o;
  bool good = true;
  json_array_foreach(json_object_get(job, "outputs"), o, name) {
    const char *text = json_string_value(name);
    if (good && is_input(c, text))
      good = batch_fail(error, "%s/%s would be overwritten, and is read; give another -o",
                        c->settings->output, text);
    if (good && !note_name(c, text, i))
      good = batch_fail(error, "out of memory: free some");
  }
  json_decref(job); /* options of its own that cannot be taken apart are told of when its turn comes */
  return good;
}

static bool check_twice(const checking *c, batch_error *error) {
  const batch_item *items = c->manifest->items;
  qsort(c->names, c->name_count, sizeof *c->names, by_key);
  for (size_t n = 1; n < c->name_count; n++)
    if (c->names[n].key == c->names[n - 1].key)
      return batch_fail(error, "%s and %s would have outputs of the same name; give one another name or id",
                        items[c->names[n - 1].item].id, items[c->names[n].item].id);
  return true;
}

bool batch_outputs_check(const batch_manifest *manifest, const batch_settings *settings, batch_error *error) {
  checking c = {.manifest = manifest, .settings = settings};
  c.inputs = calloc((size_t)manifest->count + 1, sizeof *c.inputs);
  bool good = c.inputs || batch_fail(error, "out of memory: free some");
  for (int64_t i = 0; good && i < manifest->count; i++) {
    struct stat info;
    if (stat(manifest->items[i].path, &info) == 0)
      c.inputs[i] = (known_file){info.st_dev, info.st_ino};
  }
  if (good)
    qsort(c.inputs, (size_t)manifest->count, sizeof *c.inputs, by_file);
  for (int64_t i = 0; good && i < manifest->count; i++)
    good = check_item(&c, i, error);
  good = good && check_twice(&c, error);
  free(c.inputs);
  free(c.names);
  return good;
}
