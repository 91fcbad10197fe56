/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A folder of files that appears under its name when it is complete. Until then it has a temporary one beside
 * it, "voxmend-HASH-N.tmp"; what a killed program left there is removed by the next folder for the same
 * place.
 *
 * Steps: open, put files, publish, close. What fails leaves errno.
 */
#ifndef VXM_BASE_ATOMIC_FOLDER_H
#define VXM_BASE_ATOMIC_FOLDER_H

#include "base/context.h"
#include "base/output_path.h"

#include <stddef.h>

/** Whether an entry is one that such a folder has: nothing else is ever removed.
 * @param is_folder whether it is a folder, whose entries are asked for too
 * @param depth     0 for what lies in the folder itself */
typedef bool (*vxm_folder_part_fn)(const char *name, bool is_folder, int depth);

typedef struct vxm_atomic_folder {
  vxm_output_path destination; /**< `name` may be that of a folder */
  int descriptor;              /**< of the new one, locked */
  int old;                     /**< of what it replaced, locked; -1 = none */
  /** Its name until it is published, then the name of the folder that it replaced; "" = none. */
  char temporary[VXM_TEMPORARY_NAME];
  bool is_published, has_replaced;
  const char *mark, *what; /**< as given */
  vxm_folder_part_fn is_part;
} vxm_atomic_folder;

/**
 * Makes the folder. One that is there is replaced if it has an entry `mark` and nothing that is not a part;
 * one that is empty too.
 *
 * @param path may end in slashes
 * @param mark stays the caller's until the folder is closed, and so does `what`
 * @param what the name of such a folder in messages, such as "a Zarr array"
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_ARGUMENT if something else is there
 */
vxm_status vxm_atomic_folder_open(vxm_atomic_folder *out, const char *path, const char *mark,
                                  vxm_folder_part_fn is_part, const char *what, vxm_error *error);
/** Adds a file of these bytes; false with errno set. Thread-safe. */
bool vxm_atomic_folder_put(const vxm_atomic_folder *folder, const char *name, const void *data, size_t size);
/**
 * Gives it its name; what it replaces stays until the end.
 *
 * @param path for messages
 * @return VXM_OK; VXM_ERROR_IO; VXM_ERROR_ARGUMENT if something has come there that is not replaced
 */
vxm_status vxm_atomic_folder_publish(vxm_atomic_folder *folder, const char *path, vxm_error *error);
/** Takes a published folder away again; what it had replaced is back. */
void vxm_atomic_folder_revert(vxm_atomic_folder *folder);
/** Closes it. What was not published is gone, and what was replaced. */
void vxm_atomic_folder_close(vxm_atomic_folder *folder);

#endif
