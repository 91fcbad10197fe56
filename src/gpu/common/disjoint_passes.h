/* SPDX-License-Identifier: BSD-3-Clause */
/** Parts that do not meet can be made in one pass: their parities do not mix. */
#ifndef VXM_GPU_COMMON_DISJOINT_PASSES_H
#define VXM_GPU_COMMON_DISJOINT_PASSES_H

#include "voxel/parity/parity_union.h"

/** Voxels that a part may flip or set, along bits, rows and slices of the whole space: those behind `last`
 * are left out. The layout is that of the shaders. */
typedef struct vxm_pass_box {
  uint32_t part, row_bits; /**< number of the part; bits of a row */
  uint32_t first[3], last[3];
} vxm_pass_box;

/** Triangles of parts in passes: no two parts of a pass have boxes that meet. */
typedef struct vxm_disjoint_passes {
  vxm_context *context;
  size_t count;
  uint32_t *pass_of; /**< of each part from part_begin on */
  size_t part_begin;
  size_t *triangle_end; /**< of each pass: the place behind its last triangle */
  bool ordered;         /**< triangles are looked up in `order`; else they are those from `first` on */
  uint32_t *order;      /**< numbers of triangles, pass after pass */
  size_t order_count;
  size_t first;
  vxm_pass_box *boxes; /**< of parts that may flip something, pass after pass */
  size_t box_count;
  size_t *box_end; /**< of each pass: the place behind its last box */
} vxm_disjoint_passes;

/**
 * Divides the triangles of a job's parts. Destroy with vxm_disjoint_passes_destroy, also after a failure.
 *
 * @param margin voxels by which an engine moves points at most
 * @param most   where more passes than that were needed `count` is 0, and there are no lists
 */
vxm_status vxm_disjoint_passes_create(vxm_disjoint_passes *out, vxm_context *context,
                                      const vxm_window *window, const vxm_parity_union_job *job,
                                      int64_t margin, size_t most, vxm_error *error);
void vxm_disjoint_passes_destroy(vxm_disjoint_passes *passes);

#endif
