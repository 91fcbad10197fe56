/* SPDX-License-Identifier: BSD-3-Clause */
/** The winding number at some voxels of a brick, in doubles. */
#ifndef VXM_VOXEL_WINDING_WINDING_EXACT_H
#define VXM_VOXEL_WINDING_WINDING_EXACT_H

#include "voxel/winding/winding_walk.h"

/**
 * The winding numbers of a tree's triangles at the centres of voxels. Nodes at least 16 of their radii away
 * count by their expansion, all others by the solid angles of their triangles. A centre in the plane of a
 * triangle is told apart in integers, as it is moved by (e, e^2, e^3): see voxel/lattice/lattice.h.
 *
 * @param out    number 16 z + 4 y + x is that of a voxel of the brick; others are left as they are
 * @param origin the first voxel of the brick
 * @param around a bit for each voxel that nodes must be that far away from
 * @param which  a bit for each voxel that is asked for; its number does not depend on the others
 * @param close  those of which the number is likely to be close to a half-integer. Of the others less
 * accurate sums are tried first, which do unless they come close to one
 */
void vxm_winding_exact(double out[VXM_BRICK], const vxm_winding_kernels *kernels,
                       const vxm_winding_tree *tree, const int64_t origin[3], uint64_t around, uint64_t which,
                       uint64_t close);

#endif
