/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Triangles in the order of where they lie: layer after layer of slices, and what is near each other in a
 * layer. What one triangle reads of a large octree is then still in the cache for the next, and those of some
 * slices are a range.
 */
#ifndef VXM_VOXEL_PARITY_TRIANGLE_ORDER_H
#define VXM_VOXEL_PARITY_TRIANGLE_ORDER_H

#include "voxel/parity/snapped_points.h"

enum { VXM_ORDER_LAYERS = 128 };
/** Bytes for each triangle while they are ordered. */
enum { VXM_ORDER_BYTES = 2 * sizeof(uint64_t) + 3 * sizeof(uint32_t) };

typedef struct vxm_triangle_order {
  vxm_context *context;
  vxm_triangle_set set;   /**< as it was, but the faces of each part are in order; all else belongs to
                             the set that was ordered */
  uint32_t (*corners)[3]; /**< NULL: nothing is in order */
  int layer_shift;        /**< a layer is 2^layer_shift slices thick */
  /* Of the first part's faces: by the layer of their first slice, where those of a layer begin, and the last
     layer into which those up to it reach. */
  size_t begin[VXM_ORDER_LAYERS + 1];
  uint8_t reach[VXM_ORDER_LAYERS];
} vxm_triangle_order;

/**
 * Orders triangles whose points have been placed; where there is not enough memory, or points lie too far
 * out, nothing is in order. Destroy it in any case; until then the set is not to change.
 */
void vxm_triangle_order_make(vxm_triangle_order *out, vxm_context *context, const vxm_triangle_set *triangles,
                             const vxm_snapped_points *placed);
void vxm_triangle_order_destroy(vxm_triangle_order *order);

/** A range of the first part's faces, *first to *last - 1, with all that reach into slices begin to end - 1
 * along z. */
void vxm_triangle_order_slices(const vxm_triangle_order *order, int64_t begin, int64_t end, size_t *first,
                               size_t *last);

#endif
