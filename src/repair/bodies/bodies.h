/* SPDX-License-Identifier: BSD-3-Clause */
/** Bodies that share faces, edges or vertices each get their own, for what takes parts apart by their
 * vertices. */
#ifndef VXM_REPAIR_BODIES_BODIES_H
#define VXM_REPAIR_BODIES_BODIES_H

#include "repair/state/repair_state.h"

/**
 * Cuts apart what is closed, on vertices of its own at the same positions, after the sheets that hang on it
 * (repair/bodies/hanging_sheets.h):
 *  - Groups of faces that edges connect, where they touch others at vertices and have no rim there. So an eye
 *    that touches a head is a body of its own even if both have holes elsewhere; patches that meet with
 *    their rims at a vertex stay together.
 *  - Groups that are balanced (repair/state/edge_groups.h) and have edges with more than two sides, into
 * layers: the winding number is then a whole one everywhere, and layer k is the surface of what the faces
 * wind round k times or more, those of other groups that lie around all of the group with them. So two boxes
 * that share a side, overlap or are equal become their union and, within it, what they have in common. The
 * parity of each layer tells its inside, and they nest: nothing cancels, as it does in the parity of all
 * together. Voids in a block stay voids. What is wound round the other way is turned over, unless it is a
 * void in what other groups bound (vxm_pass_orientation). Faces that lie back to back and so bound nothing
 * are left as a sheet with one side, but for those within the solid.
 *
 * A group where faces cut through each other between their edges may have no layers of whole faces; then its
 * patches that are closed for themselves are bodies (repair/bodies/whole_patches.h), and the rest stays as it
 * is. Counted as separation: vertices that there are more. state->shared_faces becomes the number of repeated
 * faces that are left.
 */
vxm_status vxm_pass_bodies(vxm_repair_state *state, bool *changed, vxm_error *error);

/**
 * The same for groups alone that wind round something one way and round something else the other way, as two
 * cubes that share a side and of which one is inside out: after that all look outward, but for voids in other
 * groups, as that of a vessel with a pin through its wall. Nothing else changes.
 */
vxm_status vxm_pass_mixed_bodies(vxm_repair_state *state, bool *changed, vxm_error *error);

#endif
