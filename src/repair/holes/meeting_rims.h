/* SPDX-License-Identifier: BSD-3-Clause */
/** Holes to be closed before faces are cut apart. */
#ifndef VXM_REPAIR_HOLES_MEETING_RIMS_H
#define VXM_REPAIR_HOLES_MEETING_RIMS_H

#include "repair/state/repair_state.h"

/**
 * Closes, by fans, the loops of at most `most` edges that meet another one, or themselves, at a vertex, where
 * every edge has one face and all run the same way. Where faces are cut apart at such vertices, what is open
 * there goes together otherwise: the rim of a box is one hole though a wall within ends at it, but each side
 * of the wall would have one of its own.
 *
 * @param[out] closed how many loops
 */
vxm_status vxm_fill_meeting(vxm_repair_state *state, size_t most, int64_t *closed, vxm_error *error);

#endif
