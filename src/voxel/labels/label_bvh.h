/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Trees of boxes over triangles, one for each label, and a tree over these: for the label whose faces are the
 * nearest to a point, or to all points of a block.
 *
 * Lengths are in the longest side of a voxel, from the minimum corner of the space on. A nearness is a float
 * made of the squared distance: distances that agree to its seven digits, or both lie below 1/3000000 of a
 * voxel, are the same nearness, so that coincident faces tie whatever their corners are rounded to.
 */
#ifndef VXM_VOXEL_LABELS_LABEL_BVH_H
#define VXM_VOXEL_LABELS_LABEL_BVH_H

#include "voxel/parts/face_labels.h"

typedef struct vxm_label_bvh vxm_label_bvh;

/**
 * Makes the trees over the faces of a labelling, whose polygons are cut into triangles. Triangles with a
 * corner that is not finite are left out.
 *
 * @param space whose origin and sides lengths are in
 * @return VXM_OK; VXM_ERROR_RANGE; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_label_bvh_create(vxm_label_bvh **out, const vxm_face_labels *labelling, const vxm_space *space,
                                vxm_error *error);
/** NULL is allowed. */
void vxm_label_bvh_destroy(vxm_label_bvh *bvh);
/** Bytes that the trees of a labelling take at most, also while they are made. */
uint64_t vxm_label_bvh_bytes(const vxm_face_labels *labelling);

/** Which labels a search is for: two of them, or all where the first is 0. */
typedef struct vxm_label_filter {
  uint32_t label[2];
  uint32_t preferred; /**< goes before all others that are as near; 0 = the lowest label does */
} vxm_label_filter;

/** A triangle as seen from a point. */
typedef struct vxm_label_hit {
  float nearness;
  uint32_t label; /**< 0 = nothing */
  uint32_t triangle;
  float distance;
  float gradient[3]; /**< of the distance: from the foot on the triangle to the point, of length 1 */
} vxm_label_hit;

/** A block of points about a middle. */
typedef struct vxm_bvh_block {
  double middle[3];
  double half[3]; /**< from the middle to the last points along each axis */
  double reach;   /**< to those in the corners */
} vxm_bvh_block;

/**
 * The nearest triangle to a point, and of equally near ones that with the lowest label.
 *
 * @param from what was found nearby, one of those asked about, to begin with; or with label 0 the nearness
 *             that is to be bettered, and if nothing does the label is 0
 */
vxm_label_hit vxm_label_bvh_nearest(const vxm_label_bvh *bvh, vxm_label_filter filter, const double p[3],
                                    const vxm_label_hit *from);

/** The nearness of what is at a distance. */
float vxm_nearness_at(double distance);
/** The nearness of a triangle. */
float vxm_label_bvh_nearness(const vxm_label_bvh *bvh, uint32_t triangle, const double p[3]);
/** A triangle as seen from a point. */
vxm_label_hit vxm_label_bvh_view(const vxm_label_bvh *bvh, uint32_t label, uint32_t triangle,
                                 const double p[3]);

/**
 * Whether a triangle, or anything else that is convex, is farther from all points of a block than another
 * one; only the distances and gradients of both, as seen from the middle, are looked at. May be wrong when it
 * says no.
 */
bool vxm_bvh_block_excludes(const vxm_bvh_block *block, const vxm_label_hit *nearest,
                            const vxm_label_hit *other);

/** Whether triangles of other labels than that of the nearest one may be nearer somewhere in a block. */
bool vxm_label_bvh_has_other(const vxm_label_bvh *bvh, vxm_label_filter filter, const vxm_bvh_block *block,
                             const vxm_label_hit *nearest);

/**
 * Lists the triangles that may be the nearest somewhere in a block, as seen from its middle.
 *
 * @param nearest to the middle
 * @return how many there are; more than `capacity` if that does not suffice
 */
size_t vxm_label_bvh_list(const vxm_label_bvh *bvh, vxm_label_filter filter, const vxm_bvh_block *block,
                          const vxm_label_hit *nearest, vxm_label_hit *out, size_t capacity);

#endif
