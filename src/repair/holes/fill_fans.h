/* SPDX-License-Identifier: BSD-3-Clause */
/** Closing holes by fans of triangles, and which components are sheets. */
#ifndef VXM_REPAIR_HOLES_FILL_FANS_H
#define VXM_REPAIR_HOLES_FILL_FANS_H

#include "repair/state/repair_state.h"

/**
 * Closes the loops of at most `most` odd edges, so that every edge gets an even number of sides. Components
 * that their caps would cover, sheets, are left open and counted in state->open_parts.
 *
 * @param[out] closed how many loops
 */
vxm_status vxm_fill_fans(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error);

/** Marks the faces of sheets (face_count elements), and counts the sheets in state->open_parts. */
vxm_status vxm_find_sheets(uint8_t *faces, vxm_repair_state *state, vxm_error *error);

#endif
