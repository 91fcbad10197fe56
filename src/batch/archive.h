/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Meshes in archives (tar, packed or not, and zip), read in place by libarchive: from front to back, in a
 * process of its own, which hands each mesh over as a file in memory. Nothing is unpacked onto the disk, and
 * an archive made to do harm ends that process alone.
 */
#ifndef VXM_BATCH_ARCHIVE_H
#define VXM_BATCH_ARCHIVE_H

#include "batch/inputs.h"

#include <sys/types.h>

/** By its name. */
bool batch_is_archive(const char *name);
/** Adds the meshes of an archive; `archive` has its id, path, size and date. */
bool batch_archive_list(batch_manifest *out, const batch_inputs *inputs, const batch_item *archive,
                        batch_error *error);

enum { BATCH_MEMBER_MAX = 4096 };

/** What a member is. */
typedef enum batch_member_kind {
  BATCH_MEMBER_FILE,
  BATCH_MEMBER_LINK, /**< a hard link: another name of a member before it */
  BATCH_MEMBER_OTHER /**< a symbolic link, a pipe, a device */
} batch_member_kind;

/** What comes out of an archive: where bytes are asked for files alone, else all but folders. */
typedef struct batch_member {
  char name[BATCH_MEMBER_MAX];
  char target[BATCH_MEMBER_MAX]; /**< of a link: the other name */
  batch_member_kind kind;
  int64_t place; /**< in the archive, from 0 */
  uint64_t bytes;
  int descriptor;    /**< of its bytes, to be closed; -1 = they were not asked for, or were too many */
  char problem[256]; /**< what is wrong with it, or "" */
} batch_member;

typedef struct batch_unpacker {
  pid_t id;
  int channel; /**< poll says when there is something; -1 = none */
} batch_unpacker;

/**
 * Begins to read an archive.
 *
 * @param most bytes of a member at most; 0 = names and sizes alone
 */
bool batch_unpacker_start(batch_unpacker *out, const char *path, uint64_t most, batch_error *error);
/** 1 with the next member; 0 at the end; -1 where the archive is damaged or unreadable from there on. Waits.
 */
int batch_unpacker_next(batch_unpacker *unpacker, batch_member *out, batch_error *error);
void batch_unpacker_end(batch_unpacker *unpacker);

#endif
