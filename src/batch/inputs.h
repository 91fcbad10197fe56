/* SPDX-License-Identifier: BSD-3-Clause */
/** From what the user names (files, folders, patterns, lists, tables, archives) to a manifest. */
#ifndef VXM_BATCH_INPUTS_H
#define VXM_BATCH_INPUTS_H

#include "batch/manifest.h"

#include <sys/stat.h>

typedef struct batch_inputs {
  char *const *names;
  int count;
  const char *const *extensions; /**< of meshes, without the dot; NULL ends the list */
  const char *except;            /**< a folder that is left out: that of the outputs; NULL = none */
} batch_inputs;

bool batch_inputs_read(batch_manifest *out, const batch_inputs *inputs, batch_error *error);

/** Whether a name stands for several meshes: that of a folder, list, table or archive, or a pattern. */
bool batch_is_several(const char *name);

/** Whether the name is that of a mesh. */
bool batch_is_mesh(const batch_inputs *inputs, const char *name);
/** The extension behind the last dot, or "". */
const char *batch_extension(const char *name);
/** When a file was changed last, in nanoseconds since 1970. */
int64_t batch_modified(const struct stat *info);
/** Notes a file that was passed over. */
void batch_pass_over(batch_manifest *manifest, const char *name);
/** The same, and of what kind it is. */
void batch_pass_over_as(batch_manifest *manifest, const char *kind);
extern const char batch_odd[], batch_hidden[], batch_leads_out[];
/** Whether a name in a path, of so many letters, is no part of a dataset: ".x", or what macOS adds. */
bool batch_is_hidden(const char *part, size_t length);

/**
 * Adds the rows of a list (.txt: a path a line) or table (.csv, .tsv: a line of column names first: path, and
 * any of id, class, split, options; others become a warning). Paths are relative to the folder of the list.
 */
bool batch_table_read(batch_manifest *out, const char *path, batch_error *error);

#endif
