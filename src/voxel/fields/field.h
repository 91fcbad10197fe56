/* SPDX-License-Identifier: BSD-3-Clause */
/** Where the values of a field, a number per voxel, go: into one array, or range after range of slices. */
#ifndef VXM_VOXEL_FIELDS_FIELD_H
#define VXM_VOXEL_FIELDS_FIELD_H

#include "base/scalar.h"
#include "grid/value_tile.h"
#include "voxel/model/memory_need.h"

typedef struct vxm_field_target {
  vxm_layout layout; /**< of the values: the first varies fastest */
  void *whole;       /**< room for the values of all slices; NULL = `put` takes them */
  /** Takes the values of slices begin..end-1, each of which follows the one before. */
  vxm_status (*put)(void *payload, const void *values, int64_t begin, int64_t end, vxm_error *error);
  void *payload;
  /**
   * NULL, or takes distances within a narrow band in place of `put`, from several threads at once: tiles that
   * begin at multiples of 8 voxels. Those that never come have the greatest distance, outside.
   */
  vxm_status (*put_tile)(void *payload, const vxm_value_tile *tile, vxm_error *error);
} vxm_field_target;

/** Slices of a field that are made at once, and the memory they take. */
typedef struct vxm_field_plan {
  vxm_window bits; /**< the shape of the windows of bits, without words */
  int64_t slices;  /**< of the field */
  uint64_t memory;
} vxm_field_plan;

/**
 * As many slices as fit the memory limit: a sixteenth of what is left is not counted on.
 *
 * @param space       of the bits, which may be finer than the field
 * @param subdivision slices of bits in a slice of the field; 0 = there are no bits
 * @param centres     the bits are of voxel centres alone, without what holds thin parts together
 * @param fixed       bytes beside those of the bits and values
 * @param value_bytes of a slice of the field, as far as the slices at hand take them; 0 where the caller has
 * them
 * @param least       slices that are needed at once, if there are so many
 * @return VXM_OK, VXM_ERROR_MEMORY_LIMIT if not even these fit
 */
vxm_status vxm_field_plan_of(vxm_field_plan *out, const vxm_model *model, const vxm_space *space,
                             vxm_layout layout, int subdivision, bool centres, uint64_t fixed,
                             uint64_t value_bytes, int64_t least, vxm_error *error);

#endif
