/* SPDX-License-Identifier: BSD-3-Clause */
/** A file of voxels that a reader process sends, on its way into a grid, a field or an octree. */
#ifndef VXM_GRIDIO_COMMON_SINK_RECEIPT_H
#define VXM_GRIDIO_COMMON_SINK_RECEIPT_H

#include "gridio/common/format.h"
#include "gridio/common/sink_fill.h"
#include "sandbox/reader_process.h"

/** A format sets what is wanted, and the sink's functions text, grid and extent; their payload is this. */
typedef struct vxm_sink_receipt {
  vxm_voxel_sink sink;
  const vxm_input *input;
  bool wants_octree;
  vxm_bits_rule rule; /**< where bits are wanted */
  vxm_sink_grid grid;
  vxm_warnings warnings;
  vxm_sink_filling filling;
  vxm_octree_pieces pieces; /**< of an octree */
  vxm_error fault;          /**< of these */
} vxm_sink_receipt;

/** Reads the file into r->filling, which holds nothing after a failure. */
vxm_status vxm_sink_receive(vxm_sink_receipt *r, const vxm_module_need *need, const char *hint,
                            vxm_error *error);
/** The box of all that is active, but for its origin, as the space that is filled. */
void vxm_sink_take_box(vxm_space *space, vxm_sink_receipt *r, const vxm_sink_extent *extent);
/** What takes the bits: a grid, or an octree. */
vxm_status vxm_sink_begin_bits(vxm_sink_receipt *r, const vxm_space *space, vxm_error *error);
/** The octree, after vxm_sink_receive; NULL after a failure. */
vxm_status vxm_sink_end_octree(vxm_sparse **out, vxm_sink_receipt *r, vxm_error *error);

#endif
