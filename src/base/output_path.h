/* SPDX-License-Identifier: BSD-3-Clause */
/** Where a file is to appear: its folder, opened, and its name there, once all links are followed. */
#ifndef VXM_BASE_OUTPUT_PATH_H
#define VXM_BASE_OUTPUT_PATH_H

#include <limits.h>
#include <stdbool.h>
#include <sys/stat.h>

typedef struct vxm_output_path {
  int folder;              /**< opened with O_PATH */
  char name[NAME_MAX + 1]; /**< no link */
  int device;              /**< what is written straight to, opened, as a rename cannot replace it; else -1 */
  bool is_strangers;       /**< after a failure: a link on the way is not to be trusted */
} vxm_output_path;

/**
 * Follows a path. A link stays a link: what it points to is the destination, also if nothing is there yet. A
 * link in a folder that everybody may write to is followed only if it belongs to this user or to the folder's
 * owner, whatever the kernel's own rule is set to: as root, a file in /tmp must not become one in /etc.
 *
 * @return false with errno set
 */
bool vxm_output_path_find(vxm_output_path *out, const char *path);
void vxm_output_path_close(vxm_output_path *destination);

enum { VXM_TEMPORARY_NAME = 48 };

/** What a file or folder is called until it is complete, "voxmend-HASH-N.tmp": the same for every process
 * that writes to this name. */
void vxm_temporary_name(char out[VXM_TEMPORARY_NAME], const char *name, int attempt);

#endif
