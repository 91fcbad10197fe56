/* SPDX-License-Identifier: BSD-3-Clause */
/** Rims of different bodies that touch at a vertex. */
#ifndef VXM_MESH_TOUCHING_BODIES_H
#define VXM_MESH_TOUCHING_BODIES_H

#include "mesh/rim_joins.h"

/**
 * Parts walks that pass a vertex twice where faces of different bodies (mesh/rim_owners.h) touch, if each of
 * these then has its rims by itself. Two cases are left as they are: where the rims of bodies follow each
 * other along a slit, as far less area closes it; and sheets, which caps over their own rims would only
 * cover.
 *
 * @param loops the walks as they are, which change
 * @return false: see b->error
 */
bool vxm_touching_bodies_part(vxm_rim_joins *b, vxm_boundary_loops *loops);

#endif
