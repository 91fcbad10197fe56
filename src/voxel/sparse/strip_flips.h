/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Flips of a slab, sorted by strip: counted, then put where those of each strip lie. A record of a slab is a
 * strip along y, above the 8 bits of a row in it, 16 y + z, above a place along x of `row_shift` bits.
 */
#ifndef VXM_VOXEL_SPARSE_STRIP_FLIPS_H
#define VXM_VOXEL_SPARSE_STRIP_FLIPS_H

#include "voxel/parity/crossing_bins.h"

/** A flip within a strip: its voxel along x, above the 8 bits of its row. */
typedef uint32_t vxm_strip_flip;

/** What is sorted is read at so many places in turn, so that a step need not wait for the one before, which
 * mostly goes to the same word. */
enum { VXM_STRIP_STREAMS = 4 };

/** Of a strip, by stream: how many flips, then where the next goes. */
typedef uint32_t vxm_strip_ends[VXM_STRIP_STREAMS];

/** Counts the flips of a piece in `ends` of its strips; returns how many there are. @param many they are put
 * with their parts, and then in one stream */
size_t vxm_strip_flips_count(vxm_strip_ends *ends, const vxm_crossing_bin_piece *piece, int row_shift,
                             bool many);
/** Puts each flip of a piece where the next one of its strip and stream goes, as they have been counted.
 * @param parts NULL, or where `part` goes beside each */
void vxm_strip_flips_put(vxm_strip_flip *flips, uint32_t *parts, vxm_strip_ends *ends,
                         const vxm_crossing_bin_piece *piece, int row_shift, uint32_t part);

#endif
