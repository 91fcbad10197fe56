/* SPDX-License-Identifier: BSD-3-Clause */
/** The rights that a new file gets. */
#ifndef VXM_BASE_NEW_MODE_H
#define VXM_BASE_NEW_MODE_H

#include <sys/stat.h>

/**
 * The mode for a file that is to be `name` in a folder, and is open; it may change the file's group. A file
 * of the same owner that it replaces hands down its nine bits and its group, never setuid, setgid and sticky:
 * what was made of somebody's file must not run with the rights of another. Otherwise the umask, or the
 * folder's default list of rights, decides.
 */
mode_t vxm_new_mode(int folder, const char *name, int descriptor);

#endif
