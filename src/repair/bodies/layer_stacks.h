/* SPDX-License-Identifier: BSD-3-Clause */
/** Patches with the same border: one region, triangulated in several ways. */
#ifndef VXM_REPAIR_BODIES_LAYER_STACKS_H
#define VXM_REPAIR_BODIES_LAYER_STACKS_H

#include "repair/bodies/layers.h"

/** A side of a patch at its border. */
typedef struct vxm_patch_border {
  size_t patch, edge;
  int turn; /**< 1 if it runs along the edge, -1 if the other way */
} vxm_patch_border;

/**
 * Chooses the layers of patches that have the same border and coincide, so that a ray only tells the winding
 * numbers before and behind all of them together. They are stacked one behind the other; a patch of the
 * opposite orientation cancels the last one before it.
 *
 * @param borders sorted by patch, then by edge
 * @param reach   as in vxm_layers_balance; layers->front is one of both
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_layers_stack(vxm_layers *layers, const vxm_patch_border *borders, size_t count,
                            const int32_t *reach, vxm_error *error);

#endif
