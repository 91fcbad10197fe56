/* SPDX-License-Identifier: BSD-3-Clause */
/** How many of the faces that repeat each other are to stay. */
#ifndef VXM_REPAIR_CLEAN_REPEATED_FACES_H
#define VXM_REPAIR_CLEAN_REPEATED_FACES_H

#include "mesh/duplicate_faces.h"
#include "repair/state/repair_state.h"

/**
 * Marks the faces that may go without the loss of a body, and without opening what is closed.
 *
 * A group is a set of faces that edges connect (repair/state/edge_groups.h). In an open group one of several
 * faces that repeat each other stays: a sheet that was drawn from both sides is one sheet, and the side stays
 * that looks away from the middle of the model, whichever comes first. In a closed group
 * a set of repeated faces that edges connect is judged as a whole:
 *  - If it is closed by itself, as a body that is there twice, one copy of each of its faces stays, also
 *    where another body shares some of them: of what was drawn from both sides, and does not lie within the
 *    solid, the outer one.
 *  - If it lies within the solid on both sides, as the wall between two rooms, or between a block and what
 *    fills a void of it, all of it goes; of what was drawn from both sides and is closed by itself, only if
 *    each of its faces lies there. Groups that lie around all of this one count (face_set_sides.h).
 *  - A fin, drawn from both sides, with a rim of its own goes, as long as such fins have no more than a tenth
 *    of the area of the rest of their group: one side of it would leave the body open. A chair that is mostly
 *    sheets of two sides does not lose them.
 *  - Else bodies share it, and neither is closed without it. Where the group is balanced, as many copies stay
 *    as there are more of one orientation than of the other: that changes no winding number. If there are as
 *    many of one as of the other, one of each stays.
 *  - Where the group is closed but not balanced (faces are turned against each other), all copies of one
 *    orientation stay if two bodies lie on the same side of them; else one does.
 *
 * @param copies      per face (vxm_duplicates_find)
 * @param[out] remove per face: 1 = it goes
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_repeated_faces_mark(vxm_repair_state *state, const vxm_copies *copies, uint8_t *remove,
                                   vxm_error *error);

#endif
