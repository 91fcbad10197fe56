/* SPDX-License-Identifier: BSD-3-Clause */
/** Turning triangles outward by looking at a voted grid. */
#ifndef VXM_VOXEL_OUTWARD_H
#define VXM_VOXEL_OUTWARD_H

#include "voxel/facets.h"
#include "voxel/winding.h"

typedef struct vxm_outward {
  vxm_context *context;
  vxm_triangle *triangles; /**< those of the chosen parts, without cones and caps */
  size_t count;
  size_t patch_count;
} vxm_outward;

/**
 * Copies the triangles of parts part_begin..part_end-1 and turns them outward.
 *
 * Triangles that meet at an edge of exactly two form patches, consistent within; a patch may consist of one
 * triangle. Which way a patch faces is read from the grid: on which side of it are more voxels set? Voxels on
 * which the voters disagree count less. Where the grid does not tell (a sheet), the patch keeps the
 * orientation that most of its area came with. Unlike ray casting this costs a few look-ups per triangle, and
 * it works across patches that share no edge.
 *
 * @param voters three grids of the lattice's space; the same grid three times if there was no vote
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_outward_create(vxm_outward *out, const vxm_facets *facets, const vxm_lattice *lattice,
                              size_t part_begin, size_t part_end, const vxm_grid *const voters[3],
                              vxm_error *error);
void vxm_outward_destroy(vxm_outward *outward);

#endif
