/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Coverage from the crossings of rows of sub-voxels, where no sub-voxel needs to be looked at but in voxels
 * with crossings.
 */
#ifndef VXM_VOXEL_FIELDS_COVERAGE_PARITY_H
#define VXM_VOXEL_FIELDS_COVERAGE_PARITY_H

#include "voxel/fields/coverage_values.h"
#include "voxel/model/model_pass.h"

/** Whether one axis settles all of a model, on the CPU, so that crossings along it are all that is needed. */
bool vxm_coverage_by_parity(const vxm_model_pass *pass);

/** What threads work with, which is kept from one window of a grid to the next. */
typedef struct vxm_coverage_scratch vxm_coverage_scratch;
void vxm_coverage_scratch_destroy(vxm_coverage_scratch *of);

/**
 * Stores the coverage of the slices of a window.
 *
 * @param fine    a window of whole slices of voxels, in sub-voxels, without words
 * @param tallies of each thread
 * @param kept    NULL before the first window of a grid; then belongs to the caller, also after a failure
 * @param done    becomes false if there are more crossings than are held at once; then nothing is stored
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_coverage_parity(const vxm_coverage_values *values, vxm_model_pass *pass,
                               const vxm_window *fine, vxm_coverage_tally *tallies,
                               vxm_coverage_scratch **kept, bool *done, vxm_error *error);

/** Bytes that a thread takes at most for rows of so many voxels and slices of so many rows, beside crossings.
 */
uint64_t vxm_coverage_parity_bytes(const vxm_model *model, int n, int64_t row_length, int64_t rows);

#endif
