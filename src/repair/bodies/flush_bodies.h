/* SPDX-License-Identifier: BSD-3-Clause */
/** Bodies that stand flush, so that rims of their openings lie on each other, are taken apart. */
#ifndef VXM_REPAIR_BODIES_FLUSH_BODIES_H
#define VXM_REPAIR_BODIES_FLUSH_BODIES_H

#include "repair/state/repair_state.h"

/**
 * Gives bodies vertices of their own where their rims lie on each other, as those of boxes without bottoms
 * that stand flush on a floor, once their vertices are welded. The opening of each is closed for itself then;
 * what is left where rims have edges in common goes round neither.
 *
 * Edges with two opposite sides connect faces to patches; patches that are not balanced by themselves at
 * another edge are one body, but where two sides of an unbalanced edge run the same way and their faces lie
 * on each other, folded flat. Bodies are parted that meet at a vertex from which rims of both go on the same
 * way, upon each other, with such faces, if both bound a volume outward. So a surface with slits stays one,
 * and so do sheets.
 *
 * Vertices that there are more are counted with those of VXM_PASS_CUT_NONMANIFOLD.
 *
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Linear time, but for sorting; where patches share no edge and no vertex that is all there is to look at. At
 * an edge with more than 64 sides, or a vertex with more than 64 ends of rims, bodies stay together.
 */
vxm_status vxm_part_flush_bodies(vxm_repair_state *state, bool *changed, vxm_error *error);

#endif
