/* SPDX-License-Identifier: BSD-3-Clause */
/** What goes between the reading process and ours: a file over there, a soup, a grid or a failure back. */
#ifndef VXM_SANDBOX_WIRE_FORMAT_H
#define VXM_SANDBOX_WIRE_FORMAT_H

#include "base/process.h"
#include "mesh/soup.h"
#include "sandbox/wire_voxels.h"

/* The reading side. Each is false if our process has gone. */

bool vxm_wire_send_progress(int channel, double fraction);
bool vxm_wire_send_failure(int channel, const vxm_error *error);
/** Something odd, though not of the file. */
bool vxm_wire_send_warning(int channel, const char *text);
bool vxm_wire_send_soup(int channel, const vxm_soup *soup);
/** That a system call was tried that a reader has no business with. May be called in a signal handler. */
bool vxm_wire_send_attempt(int channel, int64_t call);
bool vxm_wire_get(int channel, void *data, size_t size);
/** Asks for a file that the mesh refers to: its size comes in 64 bits, VXM_WIRE_REFUSED if it is not to be
 * had, and then its bytes. */
bool vxm_wire_ask(int channel, const char *name);

#define VXM_WIRE_REFUSED UINT64_MAX
enum { VXM_WIRE_NAME_MAX = 4096 };

/* Our side. */

vxm_status vxm_wire_send_size(vxm_process *receiver, uint64_t size, vxm_error *error);

/** What is to come, and what came beside it. */
typedef struct vxm_wire_listener {
  /* One of the two. */
  vxm_soup *soup;       /**< an empty one, to be filled */
  vxm_voxel_sink *sink; /**< for a grid */
  /** Sends what vxm_wire_ask waits for. The name is that of the file, as it stands in the mesh. NULL if
   * nothing may be asked for. */
  vxm_status (*answer)(void *payload, vxm_process *reader, const char *name, vxm_error *error);
  void *payload;
  bool has_failed;       /**< the error is what the reader says, not that of our own work */
  int64_t attempt;       /**< the system call that it was stopped for, or -1 */
  vxm_warnings warnings; /**< of the reader itself */
} vxm_wire_listener;

/**
 * Waits until the soup is filled, or the sink has got all that it wants. Nothing that arrives is trusted: the
 * sender may have been damaged by the file that it read.
 *
 * @return VXM_OK; the sender's failure; what the sink returns; VXM_ERROR_IO without a message if the sender
 * has gone, is late or was stopped; VXM_ERROR_FORMAT if what arrives is not what was asked for;
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_wire_receive(vxm_process *sender, vxm_wire_listener *listener, vxm_error *error);

#endif
