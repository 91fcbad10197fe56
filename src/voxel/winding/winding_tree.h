/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Triangles in binary trees, with what is needed to see them from afar: the expansion of their winding number
 * about the centre of their area (after Barill et al. 2018),
 *
 *   w(q) ~ 1/(4 pi) (N.d / r^3 - 3 M(d, d) / r^5 + 7.5 S(d, d, d) / r^7),  d from q to the centre, r = |d|,
 *
 * N the sum of vector areas, M and S the first and second moments of them, made symmetric and free of traces,
 * which do not count as 1/r is harmonic. There is a tree for each class of sizes, so that a large triangle
 * does not make the nodes of small ones large. Lengths are in voxels.
 */
#ifndef VXM_VOXEL_WINDING_WINDING_TREE_H
#define VXM_VOXEL_WINDING_WINDING_TREE_H

#include "voxel/parity/snapped_points.h"

enum { VXM_WINDING_CLASSES = 8 };

/** Where a node is; all of its triangles lie in the ball. */
typedef struct vxm_winding_node {
  double centre[3];
  float radius;
  float area;    /**< of its triangles, by 4 pi */
  uint32_t next; /**< the first of its two children, which follow each other; of a leaf, its triangle */
  bool is_leaf;
} vxm_winding_node;

/** N, -3 M: xx yy zz 2xy 2xz 2yz, and 7.5 S: xxx 3xxy 3xyy yyy 3xxz 6xyz 3yyz 3xzz 3yzz zzz; all by 4 pi, and
 * in a unit of length of its own, so that no product overflows. */
typedef struct vxm_winding_moments {
  float scale; /**< 1 / that unit, a power of two: of the radius or a voxel, what is longer */
  float area[3], first[6], second[10];
} vxm_winding_moments;

/** A triangle that is a leaf. */
typedef struct vxm_winding_triangle {
  double corner[3][3]; /**< whole lattice steps */
  float normal[3];     /**< as long as twice the area */
  float length[3];     /**< squared, of the edges ab, bc, ca */
  uint32_t point[3];   /**< the numbers of its corners: the same, the same corner */
} vxm_winding_triangle;

typedef struct vxm_winding_tree {
  vxm_context *context;
  const vxm_snapped_points *placed;
  size_t count;                    /**< of triangles */
  vxm_winding_triangle *triangles; /**< in the order of leaves */
  vxm_winding_node *nodes;
  vxm_winding_moments *moments; /**< of each node */
  size_t node_count;
  uint32_t roots[VXM_WINDING_CLASSES];
  size_t root_count;
} vxm_winding_tree;

/**
 * Builds the trees of triangles as points are placed; the points are lent.
 *
 * @param mirrored the points have been placed by a transform that turns triangles inside out
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_winding_tree_create(vxm_winding_tree *out, vxm_context *context, const uint32_t (*corners)[3],
                                   size_t count, const vxm_snapped_points *placed, bool mirrored,
                                   vxm_error *error);
void vxm_winding_tree_destroy(vxm_winding_tree *tree);

#endif
