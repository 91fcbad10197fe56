/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Where the parities along two axes differ.
 *
 * The parity of a voxel along an axis counts, mod 2, the triangles on the ray from before the grid to the
 * voxel's centre. The rays along two axes u and v to the same centre bound a quarter of the plane through it;
 * they meet the triangles an odd number of times together exactly if an odd number of the triangles' odd
 * edges pass through that quarter, as a surface meets a closed curve as often, mod 2, as its border meets
 * what the curve bounds. So the parity along v is that along u, but for the voxels with an odd number of
 * passages before them along both u and v in their slice across the third axis: a prefix XOR along both of
 * what is flipped here, in the voxel behind each passage. A surface without odd edges has none, and any axis
 * tells its parity.
 *
 * Passages and centres are told apart by the perturbation of the lattice (voxel/lattice/lattice.h), so that
 * the result has the bits that rastering the triangles along v would give.
 */
#ifndef VXM_VOXEL_PARITY_PARITY_DIFFERENCE_H
#define VXM_VOXEL_PARITY_PARITY_DIFFERENCE_H

#include "voxel/parity/columns.h"
#include "voxel/parity/crossing_bins.h"

/**
 * Puts into the bins of a voter what odd edges flip.
 *
 * @param begin,end triangles that are cones of one part: the first two corners of each are an odd edge
 * @param columns   u and v are the axes that are compared, w the one across. A passage before the window
 * counts for its first voxel along u and, if keep_before, along v. The slabs are cut along v or w
 */
void vxm_parity_difference_put(const vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                               size_t begin, size_t end, const vxm_columns *columns, vxm_crossing_bins *bins,
                               size_t worker, size_t voter);

#endif
