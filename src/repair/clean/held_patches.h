/* SPDX-License-Identifier: BSD-3-Clause */
/** Patches that only together are consistent about an edge. */
#ifndef VXM_REPAIR_CLEAN_HELD_PATCHES_H
#define VXM_REPAIR_CLEAN_HELD_PATCHES_H

#include "repair/state/repair_state.h"

/**
 * Marks patches that hold each other about an edge with an even number of sides, four or more: turned alone,
 * one would open what is closed. As all of them about an edge stay, they stay in balance.
 *
 * @param[out] held per patch, zeros before
 * @param label     per face: its patch
 * @param turn      per face: whether it runs the other way than when the edges of the state were built
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_held_patches_find(uint8_t *held, vxm_repair_state *state, const uint32_t *label,
                                 const uint8_t *turn, vxm_error *error);

#endif
