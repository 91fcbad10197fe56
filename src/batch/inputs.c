/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/inputs.h"
#include "batch/archive.h"
#include "batch/tree.h"

#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

const char *batch_extension(const char *name) {
  const char *slash = strrchr(name, '/'), *dot = strrchr(slash ? slash + 1 : name, '.');
  return dot ? dot + 1 : "";
}

static bool is_among(const char *word, const char *const *list) {
  for (; *list; list++)
    if (strcasecmp(word, *list) == 0)
      return true;
  return false;
}

bool batch_is_mesh(const batch_inputs *inputs, const char *name) {
  return is_among(batch_extension(name), inputs->extensions);
}

const char batch_odd[] = "(pipes, devices, links to nothing or back)", batch_hidden[] = "(hidden files)",
           batch_leads_out[] = "(names with ..)";

/** Counts a file, and tells once of what kind such files are. */
void batch_pass_over_as(batch_manifest *manifest, const char *kind) {
  char word[48];
  size_t used = strlen(manifest->note);
  manifest->passed_over++;
  int length = snprintf(word, sizeof word, " %s", kind);
  bool fits = length > 0 && (size_t)length < sizeof word && used + (size_t)length + 1 < sizeof manifest->note;
  const char *found = fits ? strstr(manifest->note, word) : manifest->note;
  if (!found || (fits && found[length] != ' ' && found[length] != '\0'))
    memcpy(manifest->note + used, word, (size_t)length + 1);
}

void batch_pass_over(batch_manifest *manifest, const char *name) {
  const char *extension = batch_extension(name);
  if (*extension)
    batch_pass_over_as(manifest, extension - 1); /* with its dot */
  else
    batch_pass_over_as(manifest, "(no extension)");
}

/** "./a//b" as "a/b" would be found: an id is a name, not a way. */
static const char *without_dots(const char *path) {
  while (path[0] == '.' && path[1] == '/') {
    path += 2;
    while (*path == '/')
      path++;
  }
  return path;
}

int64_t batch_modified(const struct stat *info) {
  return (int64_t)info->st_mtim.tv_sec * 1000000000 + info->st_mtim.tv_nsec;
}

static bool add_file(batch_manifest *out, const char *id, const char *path, const struct stat *info,
                     batch_error *error) {
  batch_item item = {.id = (char *)(uintptr_t)without_dots(id),
                     .path = (char *)(uintptr_t)path,
                     .bytes = (uint64_t)info->st_size,
                     .modified = batch_modified(info)};
  return batch_manifest_add(out, &item, error);
}

static bool add_archive(batch_manifest *out, const batch_inputs *inputs, const char *id, const char *path,
                        const struct stat *info, batch_error *error) {
  batch_item archive = {.id = (char *)(uintptr_t)without_dots(id),
                        .path = (char *)(uintptr_t)path,
                        .bytes = (uint64_t)info->st_size,
                        .modified = batch_modified(info)};
  return batch_archive_list(out, inputs, &archive, error);
}

bool batch_is_hidden(const char *part, size_t length) {
  static const char of_mac[] = "__MACOSX";
  return part[0] == '.' || (length == strlen(of_mac) && strncmp(part, of_mac, length) == 0);
}

/* ---- Folders ---- */

/** Going through a folder. */
typedef struct search {
  batch_manifest *out;
  const batch_inputs *inputs;
  size_t prefix; /**< letters of a path that its id does without */
  bool has_except;
  struct stat except;
  batch_error *error;
  bool has_failed;
} search;

/** A file below a folder: a mesh, an archive, or something else. */
static bool add_entry(const search *s, const batch_tree_entry *entry) {
  const char *id = entry->path + s->prefix;
  bool is_archive = batch_is_archive(entry->name);
  if (!is_archive && !batch_is_mesh(s->inputs, entry->name)) {
    batch_pass_over(s->out, entry->name);
    return true;
  }
  batch_error damaged; /* one archive of many: it is told of as a mesh that cannot be read would be */
  return is_archive && add_archive(s->out, s->inputs, id, entry->path, entry->info, &damaged)
             ? true
             : add_file(s->out, id, entry->path, entry->info, s->error);
}

/** Links are followed; those that lead back to where they are, or to nothing, are passed over, as are
 * sockets, pipes and devices. */
static batch_tree_step visit(const batch_tree_entry *entry, void *payload) {
  search *s = payload;
  bool is_hidden = entry->depth > 0 && batch_is_hidden(entry->name, strlen(entry->name));
  switch (entry->kind) {
  case BATCH_TREE_FOLDER:
    if (s->has_except && entry->info->st_dev == s->except.st_dev && entry->info->st_ino == s->except.st_ino)
      s->out->has_left_out = is_hidden = true;
    return is_hidden ? BATCH_TREE_SKIP : BATCH_TREE_ON;
  case BATCH_TREE_FILE:
    s->has_failed = !is_hidden && !add_entry(s, entry);
    break;
  case BATCH_TREE_CLOSED:
    s->has_failed = true;
    batch_fail_errno(s->error, "%s: cannot read the folder", entry->path);
    break;
  case BATCH_TREE_OTHER:
    batch_pass_over_as(s->out, batch_odd);
    break;
  case BATCH_TREE_LEFT:
    break;
  }
  return s->has_failed ? BATCH_TREE_STOP : BATCH_TREE_ON;
}

static bool add_folder(batch_manifest *out, const batch_inputs *inputs, const char *name,
                       batch_error *error) {
  size_t length = strlen(name);
  while (length > 1 && name[length - 1] == '/')
    length--;
  search s = {.out = out, .inputs = inputs, .error = error};
  /* below one folder alone names need not tell which */
  s.prefix = inputs->count == 1 ? length + (name[length - 1] != '/') : 0;
  s.has_except = inputs->except && stat(inputs->except, &s.except) == 0;
  char *path = strndup(name, length);
  bool good = path && batch_tree_walk(path, true, visit, &s);
  free(path);
  return good || (s.has_failed ? false : batch_fail_errno(error, "%s: cannot go through it", name));
}

/* ---- What is named ---- */

static bool is_list(const char *name) {
  static const char *const lists[] = {"txt", "lst", "list", "csv", "tsv", NULL};
  return strcmp(name, "-") == 0 || is_among(batch_extension(name), lists);
}

/**
 * A file is a mesh because it is named, whatever its extension.
 *
 * @param prefix letters of the name that its id does without
 */
static bool add_named(batch_manifest *out, const batch_inputs *inputs, const char *name, size_t prefix,
                      batch_error *error) {
  struct stat info;
  if (strcmp(name, "-") == 0)
    return batch_table_read(out, name, error);
  if (stat(name, &info) != 0) {
    int reason = errno;
    /* a link to nothing is told of when its turn comes, as the rows of lists are */
    if (lstat(name, &info) == 0)
      return add_file(out, name + prefix, name, &(struct stat){0}, error);
    errno = reason;
    return batch_fail_errno(error, "%s: cannot read it", name);
  }
  if (S_ISDIR(info.st_mode))
    return add_folder(out, inputs, name, error);
  if (is_list(name))
    return batch_table_read(out, name, error);
  if (batch_is_archive(name))
    return add_archive(out, inputs, inputs->count == 1 && prefix == 0 ? "" : name + prefix, name, &info,
                       error);
  return add_file(out, name + prefix, name, &info, error);
}

#ifndef GLOB_BRACE /* without {a,b}, as in musl */
#define GLOB_BRACE 0
#endif

/** A pattern that the shell has left alone, since it stood in quotes: too many names for a command line. */
static bool add_pattern(batch_manifest *out, const batch_inputs *inputs, const char *pattern,
                        batch_error *error) {
  glob_t found;
  if (glob(pattern, GLOB_BRACE, NULL, &found) != 0)
    return batch_fail(error, "%s: there is no such file, and none fits it as a pattern", pattern);
  bool good = true;
  size_t prefix =
      inputs->count == 1 ? strcspn(pattern, "*?[{") : 0; /* the folder before the first of these */
  batch_inputs several = *inputs;
  several.count += found.gl_pathc > 1; /* then an archive is not the only input */
  while (prefix > 0 && pattern[prefix - 1] != '/')
    prefix--;
  for (size_t i = 0; good && i < found.gl_pathc; i++)
    good = add_named(out, &several, found.gl_pathv[i], prefix, error);
  globfree(&found);
  return good;
}

/** A pattern, unless there is a file of that name. */
static bool is_pattern(const char *name) {
  struct stat info;
  return strpbrk(name, "*?[{") && stat(name, &info) != 0;
}

bool batch_is_several(const char *name) {
  struct stat info;
  return is_list(name) || batch_is_archive(name) || is_pattern(name) ||
         (stat(name, &info) == 0 && S_ISDIR(info.st_mode));
}

bool batch_inputs_read(batch_manifest *out, const batch_inputs *inputs, batch_error *error) {
  *out = (batch_manifest){0};
  bool good = true;
  for (int i = 0; good && i < inputs->count; i++) {
    const char *name = inputs->names[i];
    good = is_pattern(name) ? add_pattern(out, inputs, name, error) : add_named(out, inputs, name, 0, error);
  }
  if (good && out->count == 0)
    good = batch_fail(error, "%s: there is no mesh in it%s%s%s%s%s", inputs->names[0],
                      out->passed_over ? ", only" : "", out->note, out->has_left_out ? "; " : "",
                      out->has_left_out ? inputs->except : "",
                      out->has_left_out ? ", the output, is left out: give -o another folder" : "");
  good = good && batch_manifest_finish(out, error);
  if (!good)
    batch_manifest_free(out);
  return good;
}
