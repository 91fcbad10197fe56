/* SPDX-License-Identifier: BSD-3-Clause */
/** Classes and splits of meshes, as the names of their folders tell them. python/voxmend/_placement.py has
 * the same rules. */
#ifndef VXM_BATCH_PLACEMENT_H
#define VXM_BATCH_PLACEMENT_H

#include <stdbool.h>
#include <stddef.h>

/** "train", "test" or "val" for the words that stand for one of them, in any case; NULL for others. */
const char *batch_split_named(const char *word, size_t length);

/**
 * Gives what is NULL of class and split a copy of what the folders of a name tell: chair/train/chair_0001.off
 * as in ModelNet, train/chair/1.off as well. False without memory.
 */
bool batch_place(char **kind, char **split, const char *name);

#endif
