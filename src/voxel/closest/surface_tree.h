/* SPDX-License-Identifier: BSD-3-Clause */
/** A tree of boxes over triangles, for the triangle that is the nearest to a point. */
#ifndef VXM_VOXEL_CLOSEST_SURFACE_TREE_H
#define VXM_VOXEL_CLOSEST_SURFACE_TREE_H

#include "base/context.h"

typedef struct vxm_surface_tree vxm_surface_tree;

/** Takes the corners of a triangle from its owner; they are finite. */
typedef void (*vxm_surface_corners_fn)(double out[3][3], size_t triangle, const void *payload);

/** The nearest point of a surface. */
typedef struct vxm_surface_hit {
  uint32_t triangle;
  uint32_t place; /**< in the tree, to begin with when a point nearby is asked for */
  double foot[3];
} vxm_surface_hit;

/** Makes a tree over one triangle or more. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED */
vxm_status vxm_surface_tree_create(vxm_surface_tree **out, vxm_context *context, size_t count,
                                   vxm_surface_corners_fn corners, const void *payload, vxm_error *error);
/** NULL is allowed. */
void vxm_surface_tree_destroy(vxm_surface_tree *tree);
/** Bytes that a tree of so many triangles takes at most, also while it is made. */
uint64_t vxm_surface_tree_bytes(size_t count);

/**
 * The nearest triangle to a point, by vxm_closest_point. Of equally near ones, by seven digits of the squared
 * distance, the one whose plane is the most across the way to its foot goes first. Of two walls upon each
 * other it is the one that the point is behind (its corners run to the right as seen from there): that of the
 * body which the point is in. Of those left it is the nearest in further digits, then that with the lowest
 * number.
 *
 * @param near the place of a triangle that is thought to be near; it only makes the search shorter
 */
vxm_surface_hit vxm_surface_tree_nearest(const vxm_surface_tree *tree, const double p[3], uint32_t near);

/** Triangles among which the nearest to each point of a ball is. They suit points that lie close together:
 * what is looked up in the tree for all of them is looked up once. */
enum { VXM_CANDIDATES_MAX = 1024 };
typedef struct vxm_surface_candidates {
  const vxm_surface_tree *tree;
  double centre[3], scale; /**< of the ball, and 1 / how far the farthest of them may be */
  size_t count;
  /** Discs around the triangles, in their planes, from the centre on, in that scale. A normal of 0 makes a
   * ball of one. */
  float at[3][VXM_CANDIDATES_MAX], normal[3][VXM_CANDIDATES_MAX], radius[VXM_CANDIDATES_MAX];
  uint32_t places[VXM_CANDIDATES_MAX];
} vxm_surface_candidates;

/**
 * Gathers them.
 *
 * @param near as for vxm_surface_tree_nearest; takes the place of the nearest to the centre
 * @return false if they are too many to be worth it: ask the tree
 */
bool vxm_surface_candidates_gather(vxm_surface_candidates *out, const vxm_surface_tree *tree,
                                   const double centre[3], double radius, uint32_t *near);
/** The same out of those of a larger ball that holds this one. */
bool vxm_surface_candidates_narrow(vxm_surface_candidates *out, const vxm_surface_candidates *from,
                                   const double centre[3], double radius, uint32_t *near);
/** What vxm_surface_tree_nearest gives, of a point of the ball. */
vxm_surface_hit vxm_surface_candidates_nearest(const vxm_surface_candidates *candidates, const double p[3],
                                               uint32_t near);

#endif
