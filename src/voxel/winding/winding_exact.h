/* SPDX-License-Identifier: BSD-3-Clause */
/** The winding number at one voxel, in doubles. */
#ifndef VXM_VOXEL_WINDING_WINDING_EXACT_H
#define VXM_VOXEL_WINDING_WINDING_EXACT_H

#include "voxel/winding/winding_walk.h"

/**
 * The winding number of a tree's triangles at a voxel's centre. Nodes at least 16 of their radii away count
 * by their expansion, all others by the solid angles of their triangles. A centre in the plane of a triangle
 * is told apart in integers, as it is moved by (e, e^2, e^3): see voxel/lattice/lattice.h.
 *
 * @param is_close the number is likely to be close to a number and a half; else less accurate sums are tried
 *                 first, which tell on which side of it the number is unless they come close to it
 */
double vxm_winding_exact(const vxm_winding_kernels *kernels, const vxm_winding_tree *tree,
                         const int64_t voxel[3], bool is_close);

#endif
