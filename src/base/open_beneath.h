/* SPDX-License-Identifier: BSD-3-Clause */
/** Opening what a name in a stranger's file asks for, without leaving a folder. */
#ifndef VXM_BASE_OPEN_BENEATH_H
#define VXM_BASE_OPEN_BENEATH_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How a name is looked up. */
typedef enum vxm_beneath {
  VXM_BENEATH,       /**< by the kernel, or step by step where it cannot */
  VXM_BENEATH_STEPS, /**< step by step: no links and no "..", not even those that stay within */
  VXM_BENEATH_NOT    /**< anywhere that the name leads to */
} vxm_beneath;

/** Opens the folder that a file lies in; -1 with errno set. */
int vxm_folder_open(const char *path);

/**
 * Opens a regular file for reading; what else it may be (a pipe, a device, a folder) is not opened, and never
 * waited for.
 *
 * @param folder descriptor of a folder, or AT_FDCWD
 * @return a descriptor; or -1 with errno set: EXDEV if the name leads out of the folder, ELOOP at a link that
 *         is not followed, ENOTSUP if it is no regular file, ENOENT and so on
 */
int vxm_regular_open(int folder, const char *name, vxm_beneath how);

#ifdef __cplusplus
}
#endif

#endif
