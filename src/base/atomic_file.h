/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A file that appears under its name when it is complete, with its permissions. Until then it has no name at
 * all, where the file system can do that, so that a program that is killed leaves nothing; elsewhere it has a
 * temporary one, "voxmend-HASH-N.tmp", which the next file for the same place removes if nobody holds it.
 *
 * Steps: open, write, prepare, publish, close. All return false with errno set.
 */
#ifndef VXM_BASE_ATOMIC_FILE_H
#define VXM_BASE_ATOMIC_FILE_H

#include "base/output_path.h"

typedef struct vxm_atomic_file {
  vxm_output_path destination;
  int descriptor;
  char temporary[VXM_TEMPORARY_NAME]; /**< its name in the folder until it is published, then the name of the
                           file that it replaced; "" = none */
  bool is_published, has_replaced;
} vxm_atomic_file;

/** Opens a file for a destination that is no device, and takes the destination over. Only its user may read
 * it. */
bool vxm_atomic_file_open(vxm_atomic_file *out, const vxm_output_path *destination);
/**
 * After the last write: what a close would tell is told, and the permissions are set. These are those of the
 * file that is replaced if that has the same owner, without setuid, setgid and sticky bits; else those that a
 * new file has in its folder.
 */
bool vxm_atomic_file_prepare(vxm_atomic_file *file);
/** Gives a prepared file its name. If `keeps_old`, what was replaced stays for vxm_atomic_file_revert. */
bool vxm_atomic_file_publish(vxm_atomic_file *file, bool keeps_old);
/** Takes a published file away again; what it had replaced is back, if it was kept. */
void vxm_atomic_file_revert(vxm_atomic_file *file);
/** Closes it. What was not published is gone, what was kept too. */
void vxm_atomic_file_close(vxm_atomic_file *file);

#endif
