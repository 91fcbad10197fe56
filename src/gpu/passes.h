/* SPDX-License-Identifier: BSD-3-Clause */
/** Parts that do not meet can be made in one pass: their parities do not mix. */
#ifndef VXM_GPU_PASSES_H
#define VXM_GPU_PASSES_H

#include "voxel/unite.h"

/** Voxels that a part may flip or set, along bits, rows and slices of the whole space: those behind `last`
 * are left out. The layout is that of the shaders. */
typedef struct vxm_pass_box {
  uint32_t part, row_bits; /**< number of the part; bits of a row */
  uint32_t first[3], last[3];
} vxm_pass_box;

/** Facets of parts in passes: no two parts of a pass have boxes that meet. */
typedef struct vxm_passes {
  vxm_context *context;
  size_t count;
  uint32_t *pass_of; /**< of each part from part_begin on */
  size_t part_begin;
  size_t *facet_end; /**< of each pass: the place behind its last facet */
  bool ordered;      /**< facets are looked up in `order`; else they are those from `first` on */
  uint32_t *order;   /**< numbers of facets, pass after pass */
  size_t order_count;
  size_t first;
  vxm_pass_box *boxes; /**< of parts that may flip something, pass after pass */
  size_t box_count;
  size_t *box_end; /**< of each pass: the place behind its last box */
} vxm_passes;

/** Divides the facets of a job's parts. `margin`: voxels by which an engine moves points at most. Destroy
 * with vxm_passes_destroy, also after a failure. */
vxm_status vxm_passes_create(vxm_passes *out, vxm_context *context, const vxm_window *window,
                             const vxm_unite_job *job, int64_t margin, vxm_error *error);
void vxm_passes_destroy(vxm_passes *passes);

#endif
