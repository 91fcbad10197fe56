/* SPDX-License-Identifier: BSD-3-Clause */
/** The permissions that a new file gets. */
#ifndef VXM_BASE_FILE_PERMISSIONS_H
#define VXM_BASE_FILE_PERMISSIONS_H

#include <sys/stat.h>

/**
 * The mode for a file that is to be `name` in a folder, and is open; it may change the file's group. A file
 * of the same owner that it replaces hands down its nine bits and its group, never setuid, setgid and sticky:
 * what was made of somebody's file must not run with the rights of another. Otherwise the umask, or the
 * folder's default ACL, decides.
 */
mode_t vxm_file_permissions(int folder, const char *name, int descriptor);

#endif
