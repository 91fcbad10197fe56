/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons that are there several times, cut into triangles along other diagonals each time. */
#ifndef VXM_REPAIR_BODIES_OTHER_DIAGONALS_H
#define VXM_REPAIR_BODIES_OTHER_DIAGONALS_H

#include "repair/state/repair_state.h"

/**
 * Cuts such polygons alike, so that their triangles repeat each other: the fans of a polygon and of its back,
 * as exports of both sides have them, share their border but no face.
 *
 * A polygon is what triangles cover that go on over edges with two sides, almost in one plane, without a
 * vertex that is not on the border, all of whose edges have more than two sides. Those with the same border
 * get the triangles of the first, if they run along it the other way all around, or the same way and are
 * plane. Where they are not quite plane the thin body between front and back goes. A polygon whose triangles
 * have several tags stays as it is.
 *
 * That is done in groups of faces (repair/state/edge_groups.h) that are closed if each polygon is taken once,
 * or where a third of the faces or more are there already, but for those that are balanced and have a volume:
 * bodies that touch or overlap are told from each other as they are. Where inner walls are to go
 * (repair/bodies/inner_walls.h) it is enough that no edge has just one side then, sheets that hang left
 * aside.
 *
 * @param[out] changed whether there were any
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Nothing is looked at where no edge has more than two sides.
 */
vxm_status vxm_pass_other_diagonals(vxm_repair_state *state, bool *changed, vxm_error *error);

#endif
