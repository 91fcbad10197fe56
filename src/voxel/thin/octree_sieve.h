/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Puts aside triangles that cross no link without a voxel, in an octree: node by node, and brick by brick.
 *
 * A link that a triangle crosses has an end on its inner side, a voxel that lies between the plane and a
 * parallel one, a voxel further along the axis along which the normal is longest. Nearly always all of these
 * voxels are set, 64 of which are looked at together. Of a link with such a voxel nothing is to be known;
 * where one is not set, and lies in front of the triangle along an axis, the link is looked at exactly.
 */
#ifndef VXM_VOXEL_THIN_OCTREE_SIEVE_H
#define VXM_VOXEL_THIN_OCTREE_SIEVE_H

#include "voxel/parity/snapped_points.h"
#include "voxel/thin/dual_elements.h"

/** Of the links along each axis which a triangle crosses, a box with the columns of those that may have no
 * voxel at their ends; empty where there are none. */
typedef struct vxm_unsure_links {
  int64_t begin[3][3], end[3][3]; /**< voxels: that along the axis itself does not matter */
} vxm_unsure_links;

static inline vxm_unsure_links vxm_unsure_links_none(void) {
  vxm_unsure_links none;
  for (int axis = 0; axis < 3; axis++)
    for (int a = 0; a < 3; a++) {
      none.begin[axis][a] = INT64_MAX;
      none.end[axis][a] = INT64_MIN;
    }
  return none;
}

/** A triangle, in voxels from the centre of voxel (0, 0, 0) on. */
typedef struct vxm_octree_sieve {
  const vxm_sparse *octree;
  vxm_kept_bricks *kept;
  double at[3][3];
  double slope[3]; /**< its normal, by the longest component of it, along `axis` */
  double sign;     /**< of that component */
  int axis;
  int64_t begin[3], end[3]; /**< voxels of its box, and one more all around */
} vxm_octree_sieve;

/** The sieve of a triangle; false where it does not say anything: it reaches out of the view, or is too long
 * for exact numbers, or has no area. */
bool vxm_octree_sieve_of(vxm_octree_sieve *sieve, const vxm_view *view, const vxm_lattice *lattice,
                         const vxm_point corner[3]);

/** The links that may have no voxel. @param[in,out] inner -1 or 1: on which side of its normal a triangle
 * most likely has the solid. @return whether there are any */
bool vxm_octree_sieve_search(const vxm_octree_sieve *sieve, int *inner, vxm_unsure_links *unsure);

#endif
