/* SPDX-License-Identifier: BSD-3-Clause */
/** Bodies that have no layers of whole faces, but are patches that are closed for themselves. */
#ifndef VXM_REPAIR_BODIES_WHOLE_PATCHES_H
#define VXM_REPAIR_BODIES_WHOLE_PATCHES_H

#include "repair/bodies/layers.h"

/**
 * Bodies that share an edge, and cut through each other elsewhere than along edges, have no layers of whole
 * faces: a pin through the wall of a vessel, of which one side lies in that of the void. But where each patch
 * of their group is closed for itself, as many sides running along each of its edges one way as the other,
 * these patches are the bodies.
 *
 * @param[out] whole     per face that stands for a patch, zeros before: it is one of a group that failed, and
 *                       closed for itself
 * @param[in,out] failed per group: it has no layers; becomes 1 where these are cut through, and all patches
 * are whole
 * @param layers         as vxm_layers_find has left them
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 *
 * Patches with faces that are there several times are not whole.
 */
vxm_status vxm_whole_patches_find(uint8_t *whole, uint8_t *failed, const vxm_layers *layers,
                                  vxm_error *error);

#endif
