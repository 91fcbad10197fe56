/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/manifest.h"
#include "batch/placement.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool copy(char **out, const char *text) {
  *out = text ? strdup(text) : NULL;
  return *out || !text;
}

void batch_item_free(batch_item *item) {
  free(item->id);
  free(item->path);
  free(item->member);
  free(item->output);
  free(item->kind);
  free(item->split);
  free(item->options);
}

/** A name in UTF-8, with what is none of it as %XX; to be freed. */
static char *readable(const char *name, bool *is_misnamed) {
  json_t *text = json_string(name);
  json_decref(text);
  if (text)
    return strdup(name);
  char *out = malloc(3 * strlen(name) + 1), *end = out;
  *is_misnamed = true;
  for (; out && *name; name++)
    if ((unsigned char)*name >= 0x80)
      end += sprintf(end, "%%%02X", (unsigned char)*name);
    else
      *end++ = *name;
  if (out)
    *end = '\0';
  return out;
}

bool batch_manifest_add(batch_manifest *manifest, const batch_item *item, batch_error *error) {
  if (manifest->count == manifest->capacity) {
    int64_t room = manifest->capacity ? 2 * manifest->capacity : 256;
    batch_item *grown = realloc(manifest->items, (size_t)room * sizeof *grown);
    if (!grown)
      return batch_fail(error, "out of memory for the list of meshes: free some");
    manifest->items = grown;
    manifest->capacity = room;
  }
  batch_item *added = &manifest->items[manifest->count];
  *added =
      (batch_item){.bytes = item->bytes, .modified = item->modified, .place = item->place, .original = -1};
  added->id = readable(item->id, &added->is_misnamed);
  json_t *path = json_string(item->path), *member = json_string(item->member ? item->member : "");
  added->is_misnamed = added->is_misnamed || !path || !member;
  json_decref(path);
  json_decref(member);
  if (added->id && copy(&added->path, item->path) && copy(&added->member, item->member) &&
      copy(&added->kind, item->kind) && copy(&added->split, item->split) &&
      copy(&added->options, item->options)) {
    manifest->count++;
    return true;
  }
  batch_item_free(added);
  return batch_fail(error, "out of memory for the list of meshes: free some");
}

static int by_id(const void *a, const void *b) {
  return strcmp(((const batch_item *)a)->id, ((const batch_item *)b)->id);
}

/* ---- Names of outputs ---- */

/** Folders of a name that would lead out of the folder of outputs become "_". */
static char *safe_name(const char *id) {
  size_t length = strlen(id), used = 0;
  char *out = malloc(length + 2);
  while (out && *id) {
    size_t part = strcspn(id, "/");
    bool leads_out = part == 2 && id[0] == '.' && id[1] == '.';
    bool is_kept = part > 0 && !(part == 1 && id[0] == '.');
    if (is_kept && used > 0)
      out[used++] = '/';
    if (leads_out)
      out[used++] = '_';
    else if (is_kept) {
      memcpy(out + used, id, part);
      used += part;
    }
    id += part + (id[part] == '/');
  }
  if (out && used == 0)
    out[used++] = '_';
  if (out)
    out[used] = '\0';
  return out;
}

/** Where the extension begins, or the end. */
static char *extension_of(char *name) {
  char *slash = strrchr(name, '/'), *base = slash ? slash + 1 : name, *dot = strrchr(base, '.');
  return dot && dot > base ? dot : name + strlen(name);
}

/** An id that a table gives may have dots that are none of an extension: "v1.5". */
static bool has_its_extension(const batch_item *item) {
  char *file = item->member ? item->member : item->path;
  return strcasecmp(extension_of(item->output), extension_of(file)) == 0;
}

static int by_output(const void *a, const void *b) {
  const batch_item *x = *(batch_item *const *)a, *y = *(batch_item *const *)b;
  int order = strcmp(x->output, y->output);
  return order ? order : strcmp(x->id, y->id);
}

/** chair.off and chair.obj beside each other: each keeps its extension. */
static bool restore_extensions(batch_item **items, int64_t count) {
  bool good = true;
  for (int64_t i = 0; i < count;) {
    int64_t next = i + 1;
    while (next < count && strcmp(items[next]->output, items[i]->output) == 0)
      next++;
    for (int64_t same = i; next - i > 1 && same < next; same++) {
      free(items[same]->output);
      items[same]->output = safe_name(items[same]->id);
      good = good && items[same]->output;
    }
    i = next;
  }
  return good;
}

static bool name_outputs(batch_manifest *manifest, batch_error *error) {
  size_t count = (size_t)manifest->count;
  batch_item **order = malloc((count + 1) * sizeof(batch_item *));
  bool good = order != NULL;
  for (size_t i = 0; good && i < count; i++) {
    order[i] = &manifest->items[i];
    order[i]->output = safe_name(order[i]->id);
    good = order[i]->output != NULL;
    if (good && has_its_extension(order[i]))
      *extension_of(order[i]->output) = '\0';
  }
  if (good) {
    qsort(order, count, sizeof *order, by_output);
    good = restore_extensions(order, manifest->count);
  }
  if (good)
    qsort(order, count, sizeof *order, by_output);
  for (size_t i = 0; good && i < count; i++) /* "a" beside "b/../a", of a list */
    if (i + 1 < count && strcmp(order[i]->output, order[i + 1]->output) == 0) {
      batch_fail(error, "%s and %s would have the same outputs; give them other ids", order[i]->id,
                 order[i + 1]->id);
      free(order);
      return false;
    }
  free(order);
  return good || batch_fail(error, "out of memory for the list of meshes: free some");
}

/* ---- All of them ---- */

/** Where a table tells neither. */
static bool place(batch_item *item) {
  return batch_place(&item->kind, &item->split, item->id);
}

bool batch_manifest_finish(batch_manifest *manifest, batch_error *error) {
  if (manifest->count > 0)
    qsort(manifest->items, (size_t)manifest->count, sizeof *manifest->items, by_id);
  for (int64_t i = 0; i + 1 < manifest->count; i++)
    if (strcmp(manifest->items[i].id, manifest->items[i + 1].id) == 0)
      return batch_fail(error, "%s stands twice among the inputs; give each an id of its own",
                        manifest->items[i].id);
  for (int64_t i = 0; i < manifest->count; i++) {
    manifest->items[i].number = i;
    if (!place(&manifest->items[i]))
      return batch_fail(error, "out of memory for the list of meshes: free some");
  }
  return name_outputs(manifest, error);
}

int64_t batch_manifest_find(const batch_manifest *manifest, const char *id) {
  batch_item key = {.id = (char *)(uintptr_t)id};
  const batch_item *found =
      manifest->count > 0 && id
          ? bsearch(&key, manifest->items, (size_t)manifest->count, sizeof *manifest->items, by_id)
          : NULL;
  return found ? found - manifest->items : -1;
}

void batch_manifest_keep_shard(batch_manifest *manifest, int shard, int shards) {
  int64_t kept = 0;
  for (int64_t i = 0; i < manifest->count; i++)
    if (i % shards == shard)
      manifest->items[kept++] = manifest->items[i];
    else
      batch_item_free(&manifest->items[i]);
  manifest->count = kept;
}

void batch_manifest_free(batch_manifest *manifest) {
  for (int64_t i = 0; i < manifest->count; i++)
    batch_item_free(&manifest->items[i]);
  free(manifest->items);
  *manifest = (batch_manifest){0};
}
