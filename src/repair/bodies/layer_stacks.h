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
 * Chooses the layers of patches that have the same border and lie upon each other, so that a ray tells what
 * is before and behind all of them together: one after the other, and those that run the other way where they
 * cancel the last ones.
 *
 * @param borders sorted by patch, then by edge
 * @param reach   as in vxm_layers_balance; layers->front is one of both
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_layers_stack(vxm_layers *layers, const vxm_patch_border *borders, size_t count,
                            const int32_t *reach, vxm_error *error);

#endif
