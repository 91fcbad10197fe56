/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/tree.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct tree {
  bool follows;
  batch_tree_step (*visit)(const batch_tree_entry *entry, void *payload);
  void *payload;
} tree;

/** A folder and those that it is in. */
typedef struct place {
  const struct place *above;
  dev_t device;
  ino_t number;
} place;

static bool leads_back(const struct stat *info, const place *at) {
  for (; at; at = at->above)
    if (at->device == info->st_dev && at->number == info->st_ino)
      return true;
  return false;
}

static batch_tree_step tell(const tree *t, batch_tree_kind kind, const char *path, int depth,
                            const struct stat *info) {
  const char *slash = depth > 0 ? strrchr(path, '/') : NULL;
  const batch_tree_entry entry = {kind, path, slash ? slash + 1 : path, depth, info};
  return t->visit(&entry, t->payload);
}

static int is_shown(const struct dirent *entry) {
  return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
}

static int by_name(const struct dirent **a, const struct dirent **b) {
  return strcmp((*a)->d_name, (*b)->d_name);
}

static batch_tree_step walk(const tree *t, const char *path, int depth, const place *above);

static batch_tree_step walk_folder(const tree *t, const char *path, int depth, const place *at,
                                   const struct stat *info) {
  struct dirent **names = NULL;
  int count = scandir(path, &names, is_shown, by_name);
  if (count < 0)
    return errno == ENOMEM ? BATCH_TREE_STOP : tell(t, BATCH_TREE_CLOSED, path, depth, info);
  const char *slash = path[strlen(path) - 1] == '/' ? "" : "/";
  batch_tree_step step = BATCH_TREE_ON;
  for (int n = 0; n < count; n++) {
    char *inner = NULL;
    if (step != BATCH_TREE_STOP)
      step = asprintf(&inner, "%s%s%s", path, slash, names[n]->d_name) < 0 ? BATCH_TREE_STOP
                                                                           : walk(t, inner, depth + 1, at);
    free(inner);
    free(names[n]);
  }
  free(names);
  return step == BATCH_TREE_STOP ? step : tell(t, BATCH_TREE_LEFT, path, depth, info);
}

static batch_tree_step walk(const tree *t, const char *path, int depth, const place *above) {
  struct stat info;
  if ((t->follows ? stat(path, &info) : lstat(path, &info)) != 0) {
    memset(&info, 0, sizeof info);
    return tell(t, BATCH_TREE_OTHER, path, depth, &info);
  }
  if (!S_ISDIR(info.st_mode) || leads_back(&info, above))
    return tell(t, S_ISREG(info.st_mode) ? BATCH_TREE_FILE : BATCH_TREE_OTHER, path, depth, &info);
  const place at = {above, info.st_dev, info.st_ino};
  batch_tree_step step = tell(t, BATCH_TREE_FOLDER, path, depth, &info);
  return step == BATCH_TREE_ON ? walk_folder(t, path, depth, &at, &info) : step;
}

bool batch_tree_walk(const char *root, bool follows,
                     batch_tree_step (*visit)(const batch_tree_entry *entry, void *payload), void *payload) {
  const tree t = {follows, visit, payload};
  return walk(&t, root, 0, NULL) != BATCH_TREE_STOP;
}
