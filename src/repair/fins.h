/* SPDX-License-Identifier: BSD-3-Clause */
/** Repeated faces of which none may stay, or what is closed would be open. */
#ifndef VXM_REPAIR_FINS_H
#define VXM_REPAIR_FINS_H

#include "repair/work.h"

/**
 * Of faces that repeat each other one stays: a sheet that was drawn from both sides is one sheet. But where
 * an even number of them hangs on something closed, which has an even number of sides along every edge, one
 * would leave it open: a wall between two rooms that each have theirs, or a fin that sticks out from a body.
 * A fin here is a set of such faces that edges connect. It goes altogether if
 *  - its component has an even number of sides along every edge, and faces that are of no fin where the fin
 * ends;
 *  - it is a wall, without a rim of its own; or the fins with rims have no more than a tenth of the area of
 * the rest of the component, as a chair that is mostly sheets of two sides is not to lose them.
 *
 * @param even   per face: an even number of faces repeat each other (vxm_duplicates_find)
 * @param remove per face: set to 1 for those of fins that go
 */
vxm_status vxm_fins_mark(vxm_work *work, const uint8_t *even, uint8_t *remove, vxm_error *error);

#endif
