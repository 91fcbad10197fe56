/* SPDX-License-Identifier: BSD-3-Clause */
/** The numbers of a coverage by how many sub-voxels are set, and what is summed up of them. */
#ifndef VXM_VOXEL_FIELDS_COVERAGE_VALUES_H
#define VXM_VOXEL_FIELDS_COVERAGE_VALUES_H

#include "base/scalar.h"

#include <stdbool.h>
#include <stdint.h>

enum { VXM_COVERAGE_CHOICES = 8 * 8 * 8 + 1 };

/** What a worker has counted, on a line of the cache of its own. */
typedef struct vxm_coverage_tally {
  _Alignas(64) int64_t subvoxels;
  int64_t full, partial;
} vxm_coverage_tally;

typedef struct vxm_coverage_values {
  int n; /**< sub-voxels along an axis */
  vxm_scalar scalar;
  float fractions[VXM_COVERAGE_CHOICES]; /**< by the number of sub-voxels that are set */
  uint8_t bytes[VXM_COVERAGE_CHOICES];
  unsigned char *out; /**< of the slices at hand */
  bool streaming;     /**< they are stored past the cache, in which they would not stay */
} vxm_coverage_values;

/** The tables for n sub-voxels along an axis. */
vxm_coverage_values vxm_coverage_values_of(int n, vxm_scalar scalar);

/** Stores one number, and counts it. */
static inline void vxm_coverage_store(const vxm_coverage_values *values, size_t at, unsigned count,
                                      vxm_coverage_tally *tally) {
  unsigned n = (unsigned)values->n, most = n * n * n;
  if (values->scalar == VXM_UINT8)
    values->out[at] = values->bytes[count];
  else
    ((float *)(void *)values->out)[at] = values->fractions[count];
  tally->subvoxels += count;
  tally->full += count == most;
  tally->partial += count > 0 && count < most;
}

/** The same number for `some` voxels in a row. */
void vxm_coverage_store_run(const vxm_coverage_values *values, size_t at, size_t some, unsigned count,
                            vxm_coverage_tally *tally);

#endif
