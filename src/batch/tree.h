/* SPDX-License-Identifier: BSD-3-Clause */
/** Going through folders: fts(3), which not every C library has, as far as batches need it. */
#ifndef VXM_BATCH_TREE_H
#define VXM_BATCH_TREE_H

#include <stdbool.h>
#include <sys/stat.h>

typedef enum batch_tree_kind {
  BATCH_TREE_FOLDER, /**< before what is in it */
  BATCH_TREE_LEFT,   /**< a folder, behind what is in it */
  BATCH_TREE_FILE,   /**< a regular file */
  BATCH_TREE_OTHER,  /**< another file, a link, a folder that leads back to one that it is in */
  BATCH_TREE_CLOSED  /**< a folder that cannot be read: errno says why */
} batch_tree_kind;

/** Valid until the visit returns. */
typedef struct batch_tree_entry {
  batch_tree_kind kind;
  const char *path, *name; /**< the name is the end of the path */
  int depth;               /**< 0 of the root */
  const struct stat *info; /**< all zeros where a name leads nowhere */
} batch_tree_entry;

typedef enum batch_tree_step { BATCH_TREE_ON, BATCH_TREE_SKIP, BATCH_TREE_STOP } batch_tree_step;

/**
 * Visits a file, or a folder and all that is in it, the names of a folder in the order of their bytes.
 *
 * @param follows whether links are what they lead to
 * @param visit   says whether to go on, to pass a folder over, or to stop
 * @return false if it was stopped, or for want of memory (errno)
 */
bool batch_tree_walk(const char *root, bool follows,
                     batch_tree_step (*visit)(const batch_tree_entry *entry, void *payload), void *payload);

#endif
