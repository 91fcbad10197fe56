/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Oriented triangles as a closed chain and a rest.
 *
 * If R has the boundary of T, as sums of oriented edges, then T - R is closed, and the winding number of T is
 * that of T - R, an integer that crossings along any line tell, plus that of R, for which solid angles must
 * be summed up. Here T are the triangles of one component after the other (joined over edges). The boundary
 * of a component is cut into loops, wherever it comes to a vertex again, and each loop is filled by triangles
 * that cut off every second corner, again and again: small ones along the loop, few large ones. Where a
 * component has no more triangles than its boundary has edges, R is the component itself.
 */
#ifndef VXM_VOXEL_WINDING_CHAIN_H
#define VXM_VOXEL_WINDING_CHAIN_H

#include "base/context.h"

typedef struct vxm_winding_chain {
  vxm_context *context;
  uint32_t (*closed)[3]; /**< points of each triangle of T - R; NULL = not made */
  size_t closed_count;
  uint32_t (*rest)[3]; /**< of R */
  size_t rest_count;
} vxm_winding_chain;

/**
 * Makes the chain of triangles.
 *
 * @param corners     points of each triangle, counterclockwise seen from outside
 * @param count       of them, at most UINT32_MAX / 6
 * @param point_count points have smaller numbers
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT. Takes linear time
 */
vxm_status vxm_winding_chain_create(vxm_winding_chain *out, vxm_context *context,
                                    const uint32_t (*corners)[3], size_t count, size_t point_count,
                                    vxm_error *error);
void vxm_winding_chain_destroy(vxm_winding_chain *chain);

#endif
