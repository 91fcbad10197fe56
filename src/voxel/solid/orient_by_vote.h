/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Which triangles of a shape face inward. It is found once, from a solid of fixed resolution along the
 * longest side of the mesh, so that it is the same whatever grid is made of the shape.
 */
#ifndef VXM_VOXEL_SOLID_ORIENT_BY_VOTE_H
#define VXM_VOXEL_SOLID_ORIENT_BY_VOTE_H

#include "voxel/solid/solid_policy.h"

/** Bytes that finding out and then using the turns of a triangle takes at most: neighbours, sides, tree. */
#define VXM_TURNED_BYTES UINT64_C(320)
/** Bytes of the grids that are looked at: five of 260 voxels along an axis, and scratch. */
#define VXM_ORIENT_BYTES (UINT64_C(20) << 20)

/** Fills shape->open_turns, for the parts that stay open, unless that has been done. */
vxm_status vxm_orient_open(vxm_mesh_analysis *shape, vxm_error *error);
/** Fills shape->all_turns. */
vxm_status vxm_orient_all(vxm_mesh_analysis *shape, vxm_error *error);

#endif
