/* SPDX-License-Identifier: BSD-3-Clause */
/** How a soup, or a failure, goes from the reading process to ours. */
#ifndef VXM_MESHIO_PARCEL_H
#define VXM_MESHIO_PARCEL_H

#include "base/process.h"
#include "mesh/soup.h"

/* The sender's side. Each is false if the receiver has gone. */

bool vxm_parcel_send_progress(int channel, double fraction);
bool vxm_parcel_send_failure(int channel, const vxm_error *error);
bool vxm_parcel_send_soup(int channel, const vxm_soup *soup);

/**
 * Waits for the soup and fills an empty one. Nothing that arrives is trusted: the sender may have been
 * damaged by the file that it read.
 *
 * @return VXM_OK; the sender's failure; VXM_ERROR_IO without a message if the sender has gone;
 *         VXM_ERROR_FORMAT if what arrives is no soup; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_parcel_receive(vxm_soup *soup, vxm_process *sender, vxm_error *error);

#endif
