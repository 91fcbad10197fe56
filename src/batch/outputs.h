/* SPDX-License-Identifier: BSD-3-Clause */
/** What meshes are made into: files and folders below the folder of outputs. */
#ifndef VXM_BATCH_OUTPUTS_H
#define VXM_BATCH_OUTPUTS_H

#include "batch/supervisor.h"

/**
 * Describes an output: {"path", "bytes", "sha256"}, of a folder with "files" too, and the digest of all names
 * and digests in it. NULL with errno if it is not there, or not all of it can be read.
 */
json_t *batch_output_describe(const char *output, const char *name);
/** Whether an output that was described so is there, as far as can be seen without reading it. */
bool batch_output_is_there(const char *output, const json_t *described);
/** Removes "OUT/NAME" and "OUT/NAME.json". */
void batch_output_remove(const char *output, const char *name);
/** Removes a folder with all that is in it. */
void batch_folder_remove(const char *path);

/** Refuses names of outputs that stand twice, or are those of files that are read. */
bool batch_outputs_check(const batch_manifest *manifest, const batch_settings *settings, batch_error *error);

#endif
