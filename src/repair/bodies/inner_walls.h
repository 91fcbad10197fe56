/* SPDX-License-Identifier: BSD-3-Clause */
/** Walls that divide a body and are drawn once are told from its skin, and left out. */
#ifndef VXM_REPAIR_BODIES_INNER_WALLS_H
#define VXM_REPAIR_BODIES_INNER_WALLS_H

#include "repair/state/repair_state.h"

/**
 * Leaves the skin of bodies that are divided into chambers, as of several materials or compartments, by walls
 * of one sheet each: the rims of these are edges with three sides, so that neither parity nor winding numbers
 * tell what the faces bound.
 *
 * Asked are groups of faces (repair/state/edge_groups.h) with an edge that has an odd number of sides, three
 * or more. About each edge the faces are sorted by angle, and the sides of two that follow each other look
 * into one space: so the sides of a group fall into sets, one for each space that it bounds. The outer one of
 * these is that whose sides look away from a positive volume. A face of which neither side looks out is a
 * wall and goes; a face with one side that does is skin, and is turned as most of the skin is. So all
 * chambers are filled; cavities in groups of their own are not touched.
 *
 * Sheets that hang on the skin look out on both sides and stay (repair/bodies/rimmed_sheets.h). A group stays
 * as it is where another face that looks out has an edge to itself, as those of open bodies do; where faces
 * lie upon each other at an edge; and where there is not just one outer space, or a wall does not lie within
 * the skin, as where faces cut through each other.
 *
 * That happens at VXM_LEVEL_CLOSED and above, and before a mesh is voxelized (state->divides).
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_pass_inner_walls(vxm_repair_state *state, bool *changed, vxm_error *error);

/** Whether walls go from this repair at all. */
bool vxm_inner_walls_go(const vxm_repair_state *state);

#endif
