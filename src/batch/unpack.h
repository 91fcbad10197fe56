/* SPDX-License-Identifier: BSD-3-Clause */
/** The side of batch/archive.h that reads archives, in a process of its own. */
#ifndef VXM_BATCH_UNPACK_H
#define VXM_BATCH_UNPACK_H

#include "batch/archive.h"

/** What goes over for each member, the descriptor of its bytes along; and once at the end. */
typedef struct batch_unpacked {
  bool is_end;
  uint64_t bytes;
  char name[BATCH_MEMBER_MAX];
  char problem[256]; /**< with is_end: why it ends before its end; else why there are no bytes */
} batch_unpacked;

void batch_unpack(const char *path, uint64_t most, int channel);

#endif
