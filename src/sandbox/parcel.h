/* SPDX-License-Identifier: BSD-3-Clause */
/** The parcels of which a conversation with the reading process is made, for the files that send and open
 * them. */
#ifndef VXM_SANDBOX_PARCEL_H
#define VXM_SANDBOX_PARCEL_H

#include "base/process.h"

/** What comes next. Both sides are of one build, so structures go over as they are. */
typedef enum vxm_parcel_kind {
  VXM_PARCEL_PROGRESS = 1,
  VXM_PARCEL_FAILURE,
  VXM_PARCEL_SOUP,
  VXM_PARCEL_REFERENCE,
  VXM_PARCEL_ATTEMPT,
  VXM_PARCEL_WARNING,
  /* of a grid, in this order */
  VXM_PARCEL_TEXT,
  VXM_PARCEL_GRID,
  VXM_PARCEL_EXTENT,
  VXM_PARCEL_BLOCKS,
  /* or of an array */
  VXM_PARCEL_ARRAY,
  VXM_PARCEL_VALUES,
  VXM_PARCEL_END
} vxm_parcel_kind;

/* The reading side; false if our process has gone. */
bool vxm_parcel_put(int channel, const void *data, size_t size);
bool vxm_parcel_put_kind(int channel, vxm_parcel_kind kind);

/* Our side. */

/** VXM_ERROR_FORMAT for what no sound reader sends. */
vxm_status vxm_parcel_damaged(vxm_error *error);
/** Ends a text, and keeps it to one line. */
void vxm_parcel_tame(char *text, size_t size);

#endif
