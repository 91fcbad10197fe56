/* SPDX-License-Identifier: BSD-3-Clause */
/** Folders that the environment names: for temporary files, and for what is kept between runs. */
#ifndef VXM_BASE_FOLDERS_H
#define VXM_BASE_FOLDERS_H

#include <stdbool.h>

/** A variable that holds an absolute path; NULL if it is not set, is relative, or if the program has rights
 * that its user lacks. */
const char *vxm_folder_variable(const char *name);

/** Whether nobody but we and the superuser can replace what lies in a folder: it is theirs, and others either
 * cannot write to it or cannot remove what is not their own (as in /tmp). */
bool vxm_folder_is_safe(const char *path);

/** $TMPDIR, or else /tmp; NULL with errno set if the variable is there and names no absolute path to a safe
 * folder. */
const char *vxm_folder_temporary(void);

#endif
