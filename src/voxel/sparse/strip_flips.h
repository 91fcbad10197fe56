/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Flips of a slab, sorted by strip: counted, then put where those of each strip lie. Records of a slab are as
 * those of vxm_flipped_nodes.
 */
#ifndef VXM_VOXEL_SPARSE_STRIP_FLIPS_H
#define VXM_VOXEL_SPARSE_STRIP_FLIPS_H

#include "voxel/parity/crossing_bins.h"

/** Counts the flips of a piece in `ends` of its strips; returns how many there are. */
size_t vxm_strip_flips_count(uint32_t *ends, const vxm_crossing_bin_piece *piece, int row_shift);
/** Puts each flip of a piece, as a record of strip 0, where the next one of its strip goes, with `part`
 * beside it. */
void vxm_strip_flips_put(uint32_t *flips, uint32_t *parts, uint32_t *ends,
                         const vxm_crossing_bin_piece *piece, int row_shift, uint32_t part);

#endif
