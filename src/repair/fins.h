/* SPDX-License-Identifier: BSD-3-Clause */
/** Repeated faces of which none may stay, or what is closed would be open. */
#ifndef VXM_REPAIR_FINS_H
#define VXM_REPAIR_FINS_H

#include "mesh/duplicates.h"
#include "repair/work.h"

/**
 * Of faces that repeat each other one stays: a sheet that was drawn from both sides is one sheet. But where
 * an even number of them hangs on something closed, which has an even number of sides along every edge, one
 * would leave it open: a wall between two rooms that each have theirs, or a fin that sticks out from a body.
 * A fin here is a set of such faces that edges connect, all of them of both orientations, or all of one. It
 * goes altogether if
 *  - its component has an even number of sides along every edge, and faces that are of no fin where the fin
 * ends;
 *  - it is a wall of both orientations, without a rim of its own; or the fins with rims have no more than a
 * tenth of the area of the rest of the component, as a chair that is mostly sheets of two sides is not to
 * lose them.
 *
 * A fin of one orientation without a rim may be no wall: where the faces it hangs on lie on the same side of
 * it, two bodies overlap there, and share a part of their surfaces. Neither is closed without its own, so all
 * of it stays. (Where they lie on both sides it is the wall of rooms of which one is turned inside out.)
 *
 * @param even     per face: a vxm_even (vxm_duplicates_find)
 * @param remove   per face: a vxm_repeat; not 0 becomes what goes
 * @param[out] kept faces of VXM_REPEAT_SAME that stay after all
 */
vxm_status vxm_fins_mark(vxm_work *work, const uint8_t *even, uint8_t *remove, size_t *kept,
                         vxm_error *error);

#endif
