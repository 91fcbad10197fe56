/* SPDX-License-Identifier: BSD-3-Clause */
/** Messages between the reading process and ours: a word for the kind, and what that kind has behind it. */
#ifndef VXM_SANDBOX_WIRE_MESSAGE_H
#define VXM_SANDBOX_WIRE_MESSAGE_H

#include "base/process.h"

/** What follows. Both sides are of one build, so structures go over as they are. */
typedef enum vxm_message_kind {
  VXM_MESSAGE_PROGRESS = 1,
  VXM_MESSAGE_FAILURE,
  VXM_MESSAGE_SOUP,
  VXM_MESSAGE_REFERENCE,
  VXM_MESSAGE_ATTEMPT,
  VXM_MESSAGE_WARNING,
  /* of a grid, in this order */
  VXM_MESSAGE_TEXT,
  VXM_MESSAGE_GRID,
  VXM_MESSAGE_EXTENT,
  VXM_MESSAGE_BLOCKS,
  /* or of an array */
  VXM_MESSAGE_ARRAY,
  VXM_MESSAGE_VALUES,
  VXM_MESSAGE_END
} vxm_message_kind;

/* The reading side; false if our process has gone. */
bool vxm_message_send(int channel, const void *data, size_t size);
bool vxm_message_send_kind(int channel, vxm_message_kind kind);

/* Our side. */

/** VXM_ERROR_FORMAT for what no sound reader sends. */
vxm_status vxm_message_damaged(vxm_error *error);
/** Ends a text that was received, and makes it printable. */
void vxm_message_sanitize(char *text, size_t size);

#endif
