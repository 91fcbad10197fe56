/* SPDX-License-Identifier: BSD-3-Clause */
/** A grid on its way from the reading process to ours: pieces of bounded size, many blocks at a time. */
#ifndef VXM_SANDBOX_WIRE_VOXELS_H
#define VXM_SANDBOX_WIRE_VOXELS_H

#include "base/process.h"
#include "sandbox/voxel_sink.h"
#include "sandbox/wire_message.h"

/** Bytes of the blocks that go over together. */
enum { VXM_WIRE_BATCH = 1 << 15 };

/* The reading side. */

typedef struct vxm_wire_sender {
  int channel;
  bool is_gone; /**< our process has */
  size_t used;
  unsigned char batch[VXM_WIRE_BATCH];
} vxm_wire_sender;

/** A sink that sends what it gets. The sender, of which `channel` is set and the rest is 0, must outlive it.
 */
vxm_voxel_sink vxm_wire_sink(vxm_wire_sender *sender);
/** Sends the rest, and that it was all. */
bool vxm_wire_send_end(vxm_wire_sender *sender);

/* Our side. */

/** How far a grid has come. */
typedef struct vxm_wire_arrival {
  bool has_grid, has_extent, has_array, is_whole;
} vxm_wire_arrival;

/**
 * Takes what stands behind the word for the kind of a message, and hands it to the sink. Sizes, order and
 * places are checked; what the numbers say is for the sink to check.
 *
 * @return what the sink returns; VXM_ERROR_FORMAT if it is no part of a grid, or out of order; VXM_ERROR_IO,
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_wire_receive_voxels(vxm_voxel_sink *sink, vxm_wire_arrival *arrival, uint64_t kind,
                                   vxm_process *sender, vxm_error *error);

#endif
