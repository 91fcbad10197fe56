/* SPDX-License-Identifier: BSD-3-Clause */
/** The journals of a batch as a database of SQLite: tables `meshes`, `outputs` and `warnings`. */
#ifndef VXM_BATCH_EXPORT_SQLITE_H
#define VXM_BATCH_EXPORT_SQLITE_H

#include "batch/batch.h"

/** Writes the database under a temporary name and renames it; one that is there is replaced. */
bool batch_export_sqlite(const char *output, const char *path, int64_t *rows, batch_error *error);

#endif
