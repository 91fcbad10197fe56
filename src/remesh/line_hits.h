/* SPDX-License-Identifier: BSD-3-Clause */
/** Where the lines through voxel centres meet the faces of a mesh, at the ends of their runs of set voxels.
 */
#ifndef VXM_REMESH_LINE_HITS_H
#define VXM_REMESH_LINE_HITS_H

#include "grid/bitgrid.h"
#include "mesh/soup.h"

typedef struct vxm_line_hits vxm_line_hits;

/**
 * Looks for them along x, y and z. The outermost face at each end of a run counts. What a run of up to three
 * voxels bounds may be thinner than a voxel and lie anywhere between its neighbours, so there all faces
 * between these count.
 *
 * @param solid must outlive the hits; its outermost voxels are empty
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_line_hits_create(vxm_line_hits **out, const vxm_soup *soup, const vxm_grid *solid,
                                vxm_error *error);
/** NULL is allowed. */
void vxm_line_hits_destroy(vxm_line_hits *hits);

/**
 * Where the surface shall cross the links that begin in a slice: where the faces are, but so that no plate
 * comes out thinner than two thirds of a voxel.
 *
 * @param shares dims[0] x dims[1] centres of three links each, along x, y and z; only those between a set
 *               voxel and an empty one are written, with the share of the link, 0 to 1, before the surface
 */
void vxm_line_hits_slice(float (*shares)[3], const vxm_line_hits *hits, int64_t slice);

#endif
