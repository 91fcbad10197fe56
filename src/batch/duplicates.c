/* SPDX-License-Identifier: BSD-3-Clause */
/** Files with the same bytes are worked at once: the others get links to what was made. */
#include "batch/digest.h"
#include "batch/outputs.h"
#include "batch/run.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/** What refers to other files may mean something else in another folder. Of .obj and .glb some do: who
 * digests them sees that, and leaves them out. Members of archives are read without others. */
static bool is_self_contained(const batch_item *item) {
  static const char *const known[] = {"off", "ply", "stl", "obj", "glb", "3mf", "step", "stp", "iges", "igs"};
  const char *extension = batch_extension(item->path);
  bool is_one = item->member != NULL;
  for (size_t k = 0; !is_one && k < sizeof known / sizeof *known; k++)
    is_one = strcasecmp(extension, known[k]) == 0;
  return is_one;
}

static int compare_texts(const char *a, const char *b) {
  return strcmp(a ? a : "", b ? b : "");
}

/* ---- Who might be the same ---- */

static int by_size(const void *a, const void *b) {
  const batch_item *x = *(batch_item *const *)a, *y = *(batch_item *const *)b;
  return x->bytes != y->bytes ? (x->bytes < y->bytes ? -1 : 1) : (x > y) - (x < y);
}

static int by_content(const void *a, const void *b) {
  const batch_item *x = *(batch_item *const *)a, *y = *(batch_item *const *)b;
  return (x > y) - (x < y);
}

/** The items that are as long as another, in the order of the manifest. */
static batch_item **with_equal_size(const run *r, int64_t *count) {
  batch_item **list = malloc((size_t)(r->manifest->count + 1) * sizeof(batch_item *));
  int64_t all = 0;
  *count = 0;
  for (int64_t i = 0; list && i < r->manifest->count; i++)
    if (is_self_contained(&r->manifest->items[i]) && !r->manifest->items[i].refers_to_others)
      list[all++] = &r->manifest->items[i];
  if (list)
    qsort(list, (size_t)all, sizeof *list, by_size);
  for (int64_t i = 0; i < all; i++) {
    bool same_before = i > 0 && list[i - 1]->bytes == list[i]->bytes;
    bool same_behind = i + 1 < all && list[i + 1]->bytes == list[i]->bytes;
    batch_item *item = list[i];
    if (same_before || same_behind)
      list[(*count)++] =
          item; /* never ahead of what is still read: list[i - 1] may only be list[i - 1] itself */
  }
  if (list)
    qsort(list, (size_t)*count, sizeof *list, by_content);
  return list;
}

/* ---- Digests ---- */

typedef struct hashing {
  batch_item **items;
  int64_t count, next;
} hashing;

static bool is_known(const run *r, int64_t index) {
  return (r->contents[index].half[0] | r->contents[index].half[1]) != 0;
}

static batch_turn next_hashes(run *r, void *payload) {
  hashing *h = payload;
  int64_t chunk[BATCH_HASHES];
  uint64_t bytes = 0;
  int count = 0;
  size_t names = 0;
  for (; h->next < h->count && count < BATCH_HASHES && bytes < UINT64_C(64) << 20 &&
         names < BATCH_REQUEST_MAX / 4;
       h->next++) {
    int64_t index = h->items[h->next] - r->manifest->items;
    if (is_known(r, index) || h->items[h->next]->member)
      continue;
    chunk[count++] = index;
    bytes += h->items[h->next]->bytes;
    names += strlen(h->items[h->next]->path);
    names += h->items[h->next]->options ? strlen(h->items[h->next]->options) : 0;
  }
  if (count == 0)
    return BATCH_NOTHING_LEFT;
  return batch_give_hashes(r, chunk, count) ? BATCH_GIVEN_OUT : BATCH_LATER;
}

/* ---- Digests of what is in archives ---- */

/** Whether a member is asked for: one that is to be done. Those that are done have been digested. */
static bool is_unknown_member(const run *r, const batch_item *item) {
  return item->member && item->status == BATCH_PENDING && !is_known(r, item - r->manifest->items);
}

/** Of all items that are names of this member; returns how many were asked for. */
static int64_t take_digest(run *r, const batch_wanted *members, int64_t count, const batch_member *member) {
  char digest[BATCH_DIGEST] = "";
  uint64_t bytes;
  int64_t w = batch_wanted_find(members, count, member->place), taken = 0;
  if (w == count || members[w].place != member->place)
    return 0;
  if (member->descriptor < 0 || !batch_digest_open(digest, &bytes, member->descriptor))
    digest[0] = '\0';
  for (; w < count && members[w].place == member->place; w++, taken++)
    batch_take_hash(r, members[w].item, digest);
  return taken;
}

/** Reads an archive once more, until all that are asked for have come. What is wrong with it is told when it
 * is the turn of its meshes. */
static void digest_archive(run *r, batch_wanted *members, int64_t count) {
  static batch_member member;
  batch_unpacker unpacker;
  batch_error problem;
  int64_t left = count;
  const char *path = r->manifest->items[members[0].item].path;
  if (!batch_unpacker_start(&unpacker, path, batch_member_room(r->settings), &problem))
    return;
  batch_wanted_sort(members, count);
  while (left > 0 && !batch_run_stops(r) && batch_unpacker_next(&unpacker, &member, &problem) > 0) {
    left -= take_digest(r, members, count, &member);
    if (member.descriptor >= 0)
      close(member.descriptor);
    batch_progress(r->tally, r->settings, 0);
  }
  batch_unpacker_end(&unpacker);
}

/** Members of one archive stand together. */
static void digest_archives(run *r, const hashing *h) {
  batch_wanted *members = malloc((size_t)(h->count + 1) * sizeof *members);
  int64_t count = 0;
  for (int64_t i = 0; members && i < h->count && !batch_run_stops(r); i++) {
    const batch_item *item = h->items[i];
    if (!is_unknown_member(r, item))
      continue;
    if (count > 0 && strcmp(r->manifest->items[members[0].item].path, item->path) != 0) {
      digest_archive(r, members, count);
      count = 0;
    }
    members[count++] = (batch_wanted){item->place, item - r->manifest->items};
  }
  if (members && count > 0 && !batch_run_stops(r))
    digest_archive(r, members, count);
  free(members);
}

/* ---- Who is the same ---- */

typedef struct keyed {
  batch_content content;
  bool trains; /**< not in a split that is held back */
  int64_t index;
} keyed;

/** A test stays as it was published; what it has in common with the training is left out of that, and so it
 * is there that a file is called a duplicate. */
static bool is_for_training(const batch_item *item) {
  return !item->split || strcasecmp(item->split, "train") == 0;
}

static int by_key(const void *a, const void *b) {
  const keyed *x = a, *y = b;
  for (int h = 0; h < 2; h++)
    if (x->content.half[h] != y->content.half[h])
      return x->content.half[h] < y->content.half[h] ? -1 : 1;
  if (x->trains != y->trains)
    return x->trains ? 1 : -1;
  return (x->index > y->index) - (x->index < y->index);
}

static const char *file_name(const batch_item *item) {
  return item->member ? item->member : item->path;
}

static bool same_wish(const batch_item *a, const batch_item *b) {
  return strcasecmp(batch_extension(file_name(a)), batch_extension(file_name(b))) == 0 &&
         compare_texts(a->options, b->options) == 0;
}

static void mark(run *r, keyed *keys, int64_t count) {
  qsort(keys, (size_t)count, sizeof *keys, by_key);
  for (int64_t k = 1, first = 0; k < count; k++) {
    if (memcmp(&keys[k].content, &keys[first].content, sizeof keys[k].content) != 0) {
      first = k;
      continue;
    }
    batch_item *item = &r->manifest->items[keys[k].index];
    if (same_wish(item, &r->manifest->items[keys[first].index]))
      item->original = keys[first].index;
  }
}

void batch_find_duplicates(run *r) {
  enum { ROUNDS = 3 };
  hashing h = {0};
  h.items = with_equal_size(r, &h.count);
  keyed *keys = malloc((size_t)(h.count + 1) * sizeof *keys);
  if (h.items && keys) {
    for (int round = 0; round < ROUNDS && !batch_run_stops(r); round++) { /* a child may have been killed */
      h.next = 0;
      batch_run_source(r, next_hashes, &h, r->settings->jobs, NULL);
    }
    digest_archives(r, &h);
    int64_t known = 0;
    for (int64_t i = 0; i < h.count; i++) {
      int64_t index = h.items[i] - r->manifest->items;
      if (r->contents[index].half[0])
        keys[known++] = (keyed){r->contents[index], is_for_training(h.items[i]), index};
    }
    mark(r, keys, known);
  }
  free(keys);
  free(h.items);
}

/* ---- Links ---- */

/** A link to what a walk finds in a folder, in another one. */
static bool link_entry(const char *from, const char *to, const char *name) {
  char *old = NULL, *new = NULL;
  bool good = asprintf(&old, "%s/%s", from, name) >= 0 && asprintf(&new, "%s/%s", to, name) >= 0;
  good = good && link(old, new) == 0;
  free(old);
  free(new);
  return good;
}

/** Folders have no links; their files do. */
static bool link_folder(const char *from, const char *to) {
  DIR *folder = opendir(from);
  bool good = folder && mkdir(to, 0777) == 0;
  for (struct dirent *entry; good && (entry = readdir(folder)) != NULL;)
    good = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
           link_entry(from, to, entry->d_name);
  if (folder)
    closedir(folder);
  if (!good)
    batch_folder_remove(to);
  return good;
}

/** Takes the place of what is there, of a run before. */
static bool link_output(const run *r, const char *from, const char *to, bool is_folder) {
  char *old = NULL, *new = NULL;
  bool good = asprintf(&old, "%s/%s", r->settings->output, from) >= 0;
  good = good && asprintf(&new, "%s/%s", r->settings->output, to) >= 0;
  if (good && is_folder)
    batch_folder_remove(new);
  else if (good && unlink(new) != 0 && errno != ENOENT)
    good = false;
  good = good && (is_folder ? link_folder(old, new) : link(old, new) == 0);
  free(old);
  free(new);
  return good;
}

typedef struct copying {
  run *r;
  json_t **records; /**< of originals, by their index; NULL = not wanted */
} copying;

/** "chair.npy.json" of the output "chair" for the output "seat": "seat.npy.json". */
static char *renamed(const char *path, const char *from, const char *to) {
  char *name = NULL;
  size_t length = strlen(from);
  if (strncmp(path, from, length) != 0 || asprintf(&name, "%s%s", to, path + length) < 0)
    return NULL;
  return name;
}

/** Whether all files of the original have got another name, that of the duplicate. */
static bool link_outputs(run *r, const batch_item *original, const batch_item *item, json_t *record) {
  json_t *files = json_object_get(record, "outputs"), *file;
  size_t f;
  bool good = json_is_array(files);
  json_array_foreach(files, f, file) {
    const char *path = batch_json_text(file, "path");
    char *name = path ? renamed(path, original->output, item->output) : NULL;
    good = good && name && batch_make_folders(r, name) &&
           link_output(r, path, name, json_object_get(file, "files") != NULL);
    if (name)
      json_object_set_new(file, "path", batch_json_string(name));
    free(name);
  }
  return good;
}

static bool take_record(json_t *record, void *payload) {
  const copying *c = payload;
  const char *event = batch_json_text(record, "event");
  int64_t index = batch_manifest_find(c->r->manifest, batch_json_text(record, "item"));
  if (index < 0 || !event || strcmp(event, "end") != 0 || !c->records[index])
    return true;
  json_decref(c->records[index]);
  c->records[index] = json_incref(record);
  return true;
}

/** What went wrong is told of the file that was tried, whose name it begins with. */
static void tell_of_original(json_t *record, const batch_item *original) {
  const char *message = batch_json_text(record, "message");
  char *text;
  if (!message || asprintf(&text, "the same bytes as %s failed: %s", original->id, message) < 0)
    return;
  json_object_set_new(record, "message", batch_json_string(text));
  free(text);
}

/** Copies of the original's record, and of its files. */
static bool finish_duplicate(run *r, int64_t index, const json_t *of_original) {
  batch_item *item = &r->manifest->items[index];
  const batch_item *original = &r->manifest->items[item->original];
  json_t *record = json_deep_copy(of_original);
  static const char *const own[] = {"sum", "wall_ms", "cpu_ms", "peak_bytes", "companions"};
  for (size_t k = 0; k < sizeof own / sizeof *own; k++)
    json_object_del(record, own[k]);
  json_object_set_new(record, "duplicate_of", batch_json_string(original->id));
  bool is_done = batch_is_done(original->status);
  if (!is_done)
    tell_of_original(record, original);
  if (is_done && !link_outputs(r, original, item, record)) {
    json_decref(record); /* a file system without links: it is made like any other */
    item->original = -1;
    return true;
  }
  return batch_end_item(r, index, is_done ? BATCH_DUPLICATE : original->status, record);
}

void batch_link_duplicates(run *r) {
  int64_t count = r->manifest->count;
  copying c = {r, calloc((size_t)count + 1, sizeof(json_t *))};
  bool is_needed = false, good = c.records != NULL;
  for (int64_t i = 0; good && i < count; i++) {
    const batch_item *item = &r->manifest->items[i];
    if (item->original >= 0 && item->status == BATCH_PENDING && !c.records[item->original]) {
      c.records[item->original] = json_null();
      is_needed = true;
    }
  }
  good = good && (!is_needed || batch_journal_read(r->journal.path, take_record, &c, NULL, r->error));
  for (int64_t i = 0; good && i < count && !batch_run_stops(r); i++) {
    const batch_item *item = &r->manifest->items[i];
    bool is_waiting = item->original >= 0 && item->status == BATCH_PENDING;
    if (is_waiting && r->manifest->items[item->original].status != BATCH_PENDING &&
        json_is_object(c.records[item->original]))
      good = finish_duplicate(r, i, c.records[item->original]);
    batch_progress(r->tally, r->settings, 0);
  }
  for (int64_t i = 0; c.records && i < count; i++)
    json_decref(c.records[i]);
  free(c.records);
  if (!good)
    batch_break(r);
}
