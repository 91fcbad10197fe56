/* SPDX-License-Identifier: BSD-3-Clause */
/** Turning triangles outward by looking at a voted grid. */
#ifndef VXM_VOXEL_WINDING_ORIENT_PATCHES_H
#define VXM_VOXEL_WINDING_ORIENT_PATCHES_H

#include "voxel/parity/snapped_points.h"

/** How a triangle lies. */
enum { VXM_FACING_OUT, VXM_FACING_IN, VXM_FACING_UNTOLD };

/** Which triangles of parts part_begin..part_end-1 are to be turned, in the order of their triangles, cones
 * and caps left out. */
typedef struct vxm_facings {
  vxm_context *context;
  size_t part_begin, part_end;
  size_t count;
  uint8_t *facing; /**< of every triangle; NULL = not known yet */
  size_t patch_count;
} vxm_facings;

/**
 * Finds out which triangles of parts part_begin..part_end-1 face inward.
 *
 * Triangles that meet at an edge of exactly two form patches, consistent within; a patch may consist of one
 * triangle. Which way a patch faces is read from the grid: on which side of it are more voxels set? Voxels on
 * which the voters disagree count less. Where the grid does not tell (a sheet), the patch keeps the
 * orientation that most of its area came with, or is left as untold, unless it is so small that it could not
 * be told. Where these are left so are lone sheets (voxel/parts/lone_sheets.h). Unlike ray casting this costs
 * a few look-ups per triangle, and it works across patches that share no edge.
 *
 * @param placed the points on the lattice of the voters' grid
 * @param voters words of three grids, x fastest; the same three times if there was no vote
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_orient_patches_find(vxm_facings *out, const vxm_triangle_set *triangles,
                                   const vxm_snapped_points *placed, size_t part_begin, size_t part_end,
                                   const uint64_t *const voters[3], bool leave_untold, vxm_error *error);
void vxm_facings_destroy(vxm_facings *facings);

#endif
