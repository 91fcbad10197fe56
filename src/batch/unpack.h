/* SPDX-License-Identifier: BSD-3-Clause */
/** What goes over between batch/archive.h and the program that reads archives for it. */
#ifndef VXM_BATCH_UNPACK_H
#define VXM_BATCH_UNPACK_H

#include "batch/archive.h"

/** What goes over for each member, the descriptor of its bytes along; and once at the end. */
typedef struct batch_unpacked {
  bool is_end;
  uint64_t bytes;
  int64_t place;
  batch_member_kind kind;
  char name[BATCH_MEMBER_MAX], target[BATCH_MEMBER_MAX];
  char problem[256]; /**< with is_end: why it ends before its end; else why there are no bytes */
} batch_unpacked;

enum { BATCH_UNPACK_CHANNEL = 3 }; /**< descriptor of the channel in that program */

#endif
