/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/companions.h"
#include "batch/digest.h"
#include "batch/inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/** The path of a file that a mesh names, to be freed. */
static char *path_of(const char *mesh, const char *name) {
  const char *slash = strrchr(mesh, '/');
  char *path = NULL;
  int folder = slash && name[0] != '/' ? (int)(slash - mesh + 1) : 0;
  return asprintf(&path, "%.*s%s", folder, mesh, name) < 0 ? NULL : path;
}

static json_t *describe(const char *mesh, const char *name) {
  char digest[BATCH_DIGEST], *path = path_of(mesh, name);
  uint64_t bytes;
  struct stat info;
  json_t *described = NULL;
  if (path && stat(path, &info) == 0 && batch_digest_file(digest, &bytes, path))
    described = json_pack("{s:o, s:I, s:I, s:s}", "name", batch_json_string(name), "bytes", (json_int_t)bytes,
                          "modified", (json_int_t)batch_modified(&info), "sha256", digest);
  free(path);
  return described;
}

static bool is_among(const json_t *described, const char *name) {
  const json_t *one;
  size_t d;
  json_array_foreach(described, d, one) if (strcmp(batch_json_text(one, "name"), name) == 0) return true;
  return false;
}

json_t *batch_companions_describe(const char *mesh, const json_t *names) {
  json_t *all = json_array(), *name;
  size_t n;
  json_array_foreach(names, n, name) {
    const char *text = json_string_value(name);
    json_t *one = text && !is_among(all, text) ? describe(mesh, text) : NULL;
    if (one)
      json_array_append_new(all, one);
  }
  return all;
}

static bool is_same(const char *path, const json_t *described) {
  char digest[BATCH_DIGEST];
  const char *before = batch_json_text(described, "sha256");
  uint64_t bytes;
  struct stat info;
  if (stat(path, &info) != 0 || info.st_size != json_integer_value(json_object_get(described, "bytes")))
    return false;
  return batch_modified(&info) == json_integer_value(json_object_get(described, "modified")) ||
         (before && batch_digest_file(digest, &bytes, path) && strcmp(digest, before) == 0);
}

bool batch_companions_same(const char *mesh, const json_t *described) {
  const json_t *one;
  size_t d;
  bool same = true;
  json_array_foreach(described, d, one) {
    const char *name = batch_json_text(one, "name");
    char *path = same && name ? path_of(mesh, name) : NULL;
    same = path && is_same(path, one);
    free(path);
  }
  return same;
}
