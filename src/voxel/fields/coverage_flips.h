/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Where parts begin and end along rows of sub-voxels, and the coverage of voxels that comes of it.
 *
 * Each voxel has a bit for each of its sub-voxels, in the order of the rows that they lie in: the n^2 rows
 * of sub-voxels that make a row of voxels lie side by side, so a prefix XOR folds all of them at once. Only
 * voxels with a flip are looked at; those between are as full as the sub-voxels behind the last flip are.
 */
#ifndef VXM_VOXEL_FIELDS_COVERAGE_FLIPS_H
#define VXM_VOXEL_FIELDS_COVERAGE_FLIPS_H

#include "base/context.h"
#include "voxel/fields/coverage_writer.h"

/**
 * Some rows of voxels; a voxel has n = 2^shift sub-voxels along each axis. The place of a sub-voxel is
 * ((row of voxels * n + row in it) * n + slice in it) << place_bits | number in its row.
 */
typedef struct vxm_coverage_flips {
  int shift;
  int place_bits;
  size_t row_length; /**< voxels */
  size_t stride;     /**< from row to row, in voxels: whole words of `touched` */
  size_t rows;
  uint64_t *words;        /**< the bits of each voxel */
  uint64_t *touched;      /**< voxels with a flip */
  uint64_t *touched_rows; /**< rows with one */
} vxm_coverage_flips;

/** The shape, without rows. */
vxm_coverage_flips vxm_coverage_flips_of(int n, size_t row_length);
/** Bytes that so many rows take. */
uint64_t vxm_coverage_flips_bytes(const vxm_coverage_flips *flips, size_t rows);
vxm_status vxm_coverage_flips_make(vxm_coverage_flips *flips, vxm_context *context, size_t rows,
                                   vxm_error *error);
void vxm_coverage_flips_destroy(vxm_coverage_flips *flips, vxm_context *context);

/** Flips the sub-voxels from each place on to the end of its row; places in rows other than those from
 * `first` on are left out. */
void vxm_coverage_flip(vxm_coverage_flips *flips, size_t first, const uint64_t *places, size_t count);
/** Whether there is a voxel with a sub-voxel that is set. */
bool vxm_coverage_flips_any(const vxm_coverage_flips *flips);
/** Sets what is set in `from` as well, which is cleared. @return whether that was not all set before */
bool vxm_coverage_flips_unite(vxm_coverage_flips *flips, vxm_coverage_flips *from);
/** Puts the values of so many rows, the flips of which are cleared. */
void vxm_coverage_put_rows(vxm_coverage_flips *flips, size_t rows, vxm_coverage_writer *writer);

#endif
