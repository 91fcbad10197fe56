/* SPDX-License-Identifier: BSD-3-Clause */
#include "batch/placement.h"

#include <string.h>
#include <strings.h>

const char *batch_split_named(const char *word, size_t length) {
  static const char *const known[][2] = {{"train", "train"},    {"training", "train"}, {"test", "test"},
                                         {"testing", "test"},   {"val", "val"},        {"valid", "val"},
                                         {"validation", "val"}, {"validate", "val"}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (strlen(known[k][0]) == length && strncasecmp(word, known[k][0], length) == 0)
      return known[k][1];
  return NULL;
}

/** The folder before `from`, which is the beginning of a name in the path; the path if there is none. */
static const char *folder_before(const char *path, const char *from) {
  if (from > path)
    from--;
  while (from > path && from[-1] != '/')
    from--;
  return from;
}

/** Where classes and splits begin: at the class, where the last folder is a split, as in
 * data/ModelNet40/chair/train/1.off, which find lists; else at the first folder. */
static const char *first_folder(const char *name) {
  const char *slash = strrchr(name, '/');
  if (!slash)
    return name;
  const char *last = folder_before(name, slash + 1);
  return batch_split_named(last, (size_t)(slash - last)) ? folder_before(name, last) : name;
}

/** "", "." and "..", of paths in lists. */
static bool is_nameless(const char *folder, size_t length) {
  return length <= 2 && strspn(folder, ".") >= length;
}

bool batch_place(char **kind, char **split, const char *name) {
  const char *folder = first_folder(name), *slash;
  bool good = true;
  for (int depth = 0; good && (slash = strchr(folder, '/')); depth++) {
    size_t length = (size_t)(slash - folder);
    const char *named = batch_split_named(folder, length);
    char **out = named ? (depth < 2 ? split : NULL) : is_nameless(folder, length) ? NULL : kind;
    if (out && !*out) {
      *out = named ? strdup(named) : strndup(folder, length);
      good = *out != NULL;
    }
    folder = slash + 1;
  }
  return good;
}
