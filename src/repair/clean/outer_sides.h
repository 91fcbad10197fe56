/* SPDX-License-Identifier: BSD-3-Clause */
/** Which faces are to be turned over so that closed surfaces are turned outward, each by itself. */
#ifndef VXM_REPAIR_CLEAN_OUTER_SIDES_H
#define VXM_REPAIR_CLEAN_OUTER_SIDES_H

#include "repair/state/repair_state.h"

/**
 * Joins faces over the edges where two of them meet, and turns what hangs together like one of them, such
 * that it has no negative volume about the middle of the model. What has none at all is turned by its first
 * face in space.
 *
 * @param sides     per corner: its edge, of the state's edge map
 * @param counts    per face: whether it takes part; the others are not there
 * @param[out] turn per face, zeroed before: 1 = it runs the wrong way
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_outer_sides_find(uint8_t *turn, vxm_repair_state *state, const uint32_t *sides,
                                const uint8_t *counts, vxm_error *error);

#endif
