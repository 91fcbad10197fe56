/* SPDX-License-Identifier: BSD-3-Clause */
/** Which meshes are in an archive: as if it were unpacked, and its folder given. */
#include "batch/archive.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** A hard link, names without "./". */
typedef struct hard_link {
  char *name, *target;
  int64_t place;
} hard_link;

typedef struct listing {
  batch_manifest *out;
  const batch_inputs *inputs;
  const batch_item *archive;
  int64_t first; /**< of the items that are its members */
  hard_link *links;
  size_t link_count, link_capacity;
  batch_error *error;
} listing;

static bool no_memory(const listing *l) {
  return batch_fail(l->error, "out of memory for the list of meshes: free some");
}

/* ---- Names ---- */

/** "./a//b" and "/a/b" as "a/b": where it would come to lie. False, and a kind to be told, for one that no
 * folder would give: that of a hidden file, or one that leads out of it. */
static bool take_name(char out[BATCH_MEMBER_MAX], const char *name, const char **kind) {
  size_t used = 0;
  *kind = NULL;
  for (; *name; name += *name == '/') {
    size_t part = strcspn(name, "/");
    bool is_dot = part == 1 && name[0] == '.', is_up = part == 2 && name[0] == '.' && name[1] == '.';
    if (is_up || (!is_dot && batch_is_hidden(name, part)))
      *kind = is_up || *kind == batch_leads_out ? batch_leads_out : batch_hidden;
    if (part > 0 && !is_dot) {
      if (used > 0)
        out[used++] = '/';
      memcpy(out + used, name, part);
      used += part;
    }
    name += part;
  }
  out[used] = '\0';
  return !*kind;
}

/* ---- Adding ---- */

static bool add_item(const listing *l, const char *name, uint64_t bytes, int64_t place) {
  char *id = NULL;
  const char *above = l->archive->id;
  if (asprintf(&id, "%s%s%s", above, *above ? "/" : "", name) < 0)
    return no_memory(l);
  batch_item item = *l->archive;
  item.id = id;
  item.member = (char *)(uintptr_t)name;
  item.bytes = bytes;
  item.place = place;
  bool good = batch_manifest_add(l->out, &item, l->error);
  free(id);
  return good;
}

static bool add_link(listing *l, const char *name, const char *target, int64_t place) {
  if (l->link_count == l->link_capacity) {
    size_t room = l->link_capacity ? 2 * l->link_capacity : 64;
    hard_link *grown = realloc(l->links, room * sizeof *grown);
    if (!grown)
      return no_memory(l);
    l->links = grown;
    l->link_capacity = room;
  }
  hard_link *added = &l->links[l->link_count];
  *added = (hard_link){strdup(name), strdup(target), place};
  l->link_count++;
  return (added->name && added->target) || no_memory(l);
}

static bool add_member(listing *l, const batch_member *member) {
  char name[BATCH_MEMBER_MAX], target[BATCH_MEMBER_MAX];
  const char *kind, *of_target;
  if (!take_name(name, member->name, &kind) || member->kind == BATCH_MEMBER_OTHER) {
    batch_pass_over_as(l->out, kind ? kind : batch_odd);
    return true;
  }
  if (!batch_is_mesh(l->inputs, name)) {
    batch_pass_over(l->out, name);
    return true;
  }
  if (member->kind == BATCH_MEMBER_FILE)
    return add_item(l, name, member->bytes, member->place);
  take_name(target, member->target, &of_target);
  return add_link(l, name, target, member->place);
}

/* ---- Several of one name ---- */

static int by_name(const void *a, const void *b) {
  const batch_item *x = a, *y = b;
  int order = strcmp(x->member, y->member);
  return order ? order : (x->place > y->place) - (x->place < y->place);
}

/** Where it is unpacked the last of them stays. */
static void keep_last(const listing *l) {
  batch_manifest *m = l->out;
  int64_t kept = l->first;
  if (m->count > l->first)
    qsort(m->items + l->first, (size_t)(m->count - l->first), sizeof *m->items, by_name);
  for (int64_t i = l->first; i < m->count; i++)
    if (i + 1 < m->count && strcmp(m->items[i].member, m->items[i + 1].member) == 0) {
      batch_item_free(&m->items[i]);
      batch_pass_over_as(m, "(replaced by later members)");
    } else
      m->items[kept++] = m->items[i];
  m->count = kept;
}

/* ---- Hard links ---- */

/** A file of that name, by its index; -1 = none. */
static int64_t find(const listing *l, int64_t files, const char *name) {
  int64_t low = l->first, high = files;
  while (low < high) {
    int64_t middle = low + (high - low) / 2;
    int order = strcmp(name, l->out->items[middle].member);
    if (order == 0)
      return middle;
    if (order < 0)
      high = middle;
    else
      low = middle + 1;
  }
  return -1;
}

static int by_link_name(const void *a, const void *b) {
  const hard_link *x = a, *y = b;
  int order = strcmp(x->name, y->name);
  return order ? order : (x->place > y->place) - (x->place < y->place);
}

/** A link has the place of what it is another name of. One that leads to no mesh is passed over, as it is
 * where it has the name of a file. */
static bool follow(const listing *l) {
  const int64_t files = l->out->count;
  bool good = true;
  if (l->link_count > 0)
    qsort(l->links, l->link_count, sizeof *l->links, by_link_name);
  for (size_t k = 0; good && k < l->link_count; k++) {
    const hard_link *link = &l->links[k];
    bool is_replaced = k + 1 < l->link_count && strcmp(link->name, link[1].name) == 0;
    int64_t target = find(l, files, link->target);
    if (is_replaced || target < 0 || find(l, files, link->name) >= 0)
      batch_pass_over_as(l->out, batch_odd);
    else
      good = add_item(l, link->name, l->out->items[target].bytes, l->out->items[target].place);
  }
  return good;
}

bool batch_archive_list(batch_manifest *out, const batch_inputs *inputs, const batch_item *archive,
                        batch_error *error) {
  static batch_member member;
  batch_unpacker unpacker;
  batch_error problem;
  listing l = {.out = out, .inputs = inputs, .archive = archive, .first = out->count, .error = error};
  if (!batch_unpacker_start(&unpacker, archive->path, 0, error))
    return false;
  int got = 0;
  bool good = true;
  while (good && (got = batch_unpacker_next(&unpacker, &member, &problem)) > 0)
    good = add_member(&l, &member);
  batch_unpacker_end(&unpacker);
  if (good && got < 0)
    good = batch_fail(error, "%s: %s", archive->path, problem.text);
  if (good) {
    keep_last(&l);
    good = follow(&l);
  }
  for (size_t k = 0; k < l.link_count; k++) {
    free(l.links[k].name);
    free(l.links[k].target);
  }
  free(l.links);
  return good;
}
