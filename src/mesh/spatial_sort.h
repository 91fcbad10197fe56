/* SPDX-License-Identifier: BSD-3-Clause */
/** Points in an order in which those side by side are near each other. */
#ifndef VXM_MESH_SPATIAL_SORT_H
#define VXM_MESH_SPATIAL_SORT_H

#include "base/context.h"

typedef struct vxm_spatial_point {
  float at[3];
  uint32_t index; /**< goes with it */
} vxm_spatial_point;

/** Points side by side that are in no order. */
enum { VXM_SPATIAL_SORT_LEAF = 8 };

/**
 * Sorts points as the leaves of a tree of boxes in which each run of 8, 16, 32, ... points that begins at a
 * multiple of its length is a node: cut in two along its longest side, none on one side being farther along
 * than one on the other. Takes n log n steps.
 *
 * @param context its threads sort; NULL = the calling thread alone, which then cannot be cancelled
 * @return VXM_OK, VXM_ERROR_CANCELLED
 */
vxm_status vxm_spatial_sort(vxm_spatial_point *points, size_t count, vxm_context *context, vxm_error *error);

#endif
