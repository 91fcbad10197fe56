/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The generalized winding number of oriented triangles (Jacobson et al. 2013), hierarchically (Barill et al.
 * 2018):
 *
 *   w(q) = 1/(4 pi) * sum over triangles of the solid angle under which q sees them,
 *
 * which is 1 inside and 0 outside of a closed surface that faces outward, and close to that where pieces are
 * missing.
 *
 * The triangles are sorted into a tree. Voxels are asked for in bricks of 4 x 4 x 4. A node whose bounding
 * radius is r and whose distance from the brick's centre is at least 2 r + s, where s is the radius of the
 * brick's centres, counts as the first two terms of its expansion about its area's centre. The terms left out
 * are, for a node of area A at distance d, at most 3 A r^2 / (4 pi (d - r)^4), because the third derivatives
 * of 1/|x| are at most 6/|x|^4. Nearer nodes are opened, down to single triangles, whose solid angle is
 * computed (Van Oosterom & Strackee 1983). Arithmetic is in floats relative to the brick, the same on every
 * machine.
 */
#ifndef VXM_VOXEL_WINDING_WINDING_H
#define VXM_VOXEL_WINDING_WINDING_H

#include "base/context.h"

/** A triangle in voxel units. */
typedef struct vxm_winding_triangle {
  double corner[3][3];
} vxm_winding_triangle;

typedef struct vxm_winding vxm_winding;

enum { VXM_BRICK = 64 /**< voxels of a brick */ };

/**
 * Builds the tree. `triangles` is put in another order and must outlive the tree.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_winding_create(vxm_winding **out, vxm_context *context, vxm_winding_triangle *triangles,
                              size_t count, vxm_error *error);
void vxm_winding_destroy(vxm_winding *winding);

/** Winding numbers at the centres of voxels (i + x, j + y, k + z), x, y, z below 4: value[16 z + 4 y + x]. */
void vxm_winding_brick(const vxm_winding *winding, int64_t i, int64_t j, int64_t k, float value[VXM_BRICK]);

#endif
