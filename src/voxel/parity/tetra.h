/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The tetrahedral XOR as published (Rueda et al., sections 3 and 4): every triangle makes a tetrahedron with
 * the apex of its part, and every tetrahedron is scan-converted, slice by slice and row by row, by flipping
 * the presence of the voxels it covers. Its cost follows the volume of the tetrahedra; parity with cones
 * (triangle_set.h) gives the same bits for the price of the surface.
 */
#ifndef VXM_VOXEL_PARITY_TETRA_H
#define VXM_VOXEL_PARITY_TETRA_H

#include "voxel/parity/parity_union.h"

/** As vxm_parity_union, with the voxels covered by an odd number of tetrahedra of at least one part. Roles
 * and axis are ignored; the apexes have been placed. */
vxm_status vxm_tetra_unite(vxm_workspace *workspace, const vxm_window *window,
                           const vxm_parity_union_job *job, vxm_error *error);

#endif
