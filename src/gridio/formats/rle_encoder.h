/* SPDX-License-Identifier: BSD-3-Clause */
/** Run lengths, for the formats that are made of them: .binvox and .rle. */
#ifndef VXM_GRIDIO_FORMATS_RLE_ENCODER_H
#define VXM_GRIDIO_FORMATS_RLE_ENCODER_H

#include "gridio/common/format.h"

typedef enum vxm_rle_code {
  VXM_RUN_PAIRS, /**< (value, count) with counts of 1 to 255 */
  VXM_RUN_BYTES  /**< clear and set in turn: 255 goes on, 0 to 254 ends a run; the last run needs no end */
} vxm_rle_code;

/** The sequence of voxels that is coded. */
typedef struct vxm_rle_shape {
  vxm_rle_code code;
  size_t length;      /**< bits of a row, at most VXM_DIM_MAX */
  uint64_t row_gap;   /**< clear voxels behind each row, below VXM_DIM_MAX */
  uint64_t slice_gap; /**< and behind each slice */
} vxm_rle_shape;

/** Bytes of the state for so many rows in all. It is the `state` of the slices. */
size_t vxm_rle_encoder_bytes(const vxm_rle_shape *shape, uint64_t rows);
void vxm_rle_encoder_begin(void *state, const vxm_rle_shape *shape, uint64_t rows);
/** Codes the rows of a window. */
vxm_status vxm_rle_encoder_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error);
/** Appends clear voxels. */
void vxm_rle_encoder_skip(vxm_grid_writer *writer, uint64_t count);
/** Writes the last run. */
void vxm_rle_encoder_end(vxm_grid_writer *writer);

#endif
