/* SPDX-License-Identifier: BSD-3-Clause */
/** A tree of boxes over triangles, and the distances of blocks of points to the nearest of them. */
#ifndef VXM_VOXEL_CLOSEST_DISTANCE_BVH_H
#define VXM_VOXEL_CLOSEST_DISTANCE_BVH_H

#include "base/context.h"

typedef struct vxm_distance_bvh vxm_distance_bvh;

/** Takes the corners of a triangle from its owner. */
typedef void (*vxm_distance_bvh_corners_fn)(double out[3][3], size_t triangle, const void *payload);

/**
 * Makes a tree over one triangle or more.
 *
 * @param corners called from several threads
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_distance_bvh_create(vxm_distance_bvh **out, vxm_context *context, size_t count,
                                   vxm_distance_bvh_corners_fn corners, const void *payload,
                                   vxm_error *error);
/** NULL is allowed. */
void vxm_distance_bvh_destroy(vxm_distance_bvh *tree);
/** Bytes that a tree of so many triangles takes at most, and those of a search. */
uint64_t vxm_distance_bvh_bytes(size_t count);
uint64_t vxm_distance_bvh_search_bytes(size_t count);

/** What a search works with; each thread has its own. */
typedef struct vxm_search vxm_search;

vxm_status vxm_search_create(vxm_search **out, const vxm_distance_bvh *tree, vxm_error *error);
/** NULL is allowed. */
void vxm_search_destroy(vxm_search *search);

/** Points along an edge of a tile. */
enum { VXM_BVH_TILE = 16, VXM_BVH_TILE_POINTS = VXM_BVH_TILE * VXM_BVH_TILE * VXM_BVH_TILE };

/** Points of a lattice: point (i,j,k) has the coordinates (i + 1/2) * step[0] and so on. */
typedef struct vxm_point_block {
  int64_t first[3]; /**< the first point of the tile */
  int count[3];     /**< points along each axis, 1 to VXM_BVH_TILE */
  double step[3];
  double max_distance; /**< what is as far or farther does not matter; INFINITY = all does */
} vxm_point_block;

/**
 * Squared distances of the points of a tile to the nearest triangle: the least that
 * vxm_triangle_distance2 gives, in all builds to the bit, where that is below max_distance^2; elsewhere
 * something that is no less than that.
 *
 * @param squares VXM_BVH_TILE rows of VXM_BVH_TILE for each of VXM_BVH_TILE slices, of which the points are
 * filled
 * @return false if no point is nearer than `max_distance`; then there are no squares
 */
typedef bool vxm_distance_bvh_tile_fn(vxm_search *search, double *squares, const vxm_point_block *tile);

/** The build for this processor. */
vxm_distance_bvh_tile_fn *vxm_distance_bvh_tile_best(void);
/** All builds that run on it; returns how many. */
size_t vxm_distance_bvh_tile_all(vxm_distance_bvh_tile_fn *out[2]);

#endif
