/* SPDX-License-Identifier: BSD-3-Clause */
/** Tolerant welding: groups of vertices that are near each other and far from all others. */
#ifndef VXM_MESH_NEAR_VERTICES_H
#define VXM_MESH_NEAR_VERTICES_H

#include "base/context.h"

/** What part a vertex takes. */
typedef enum vxm_near_role {
  VXM_NEAR_ABSENT = 0, /**< none */
  VXM_NEAR_MEMBER,     /**< may be merged */
  VXM_NEAR_OBSTACLE    /**< is not merged, and keeps the members near it from being merged */
} vxm_near_role;

/**
 * Maps every vertex to the lowest one of its group, or to itself.
 *
 * Members no farther apart than the tolerance are linked, and what links connect is a group. A group is
 * merged if the diagonal of its bounding box is at most the tolerance and no obstacle is that near to any of
 * it. So
 *  - no two merged vertices are farther apart than the tolerance;
 *  - two members that are near each other, and to no other vertex, are merged;
 *  - a chain of vertices that are near their neighbours only is left alone, whatever the order of vertices;
 *  - what was merged is farther than the tolerance from all other members and obstacles: doing it again on
 * the result may merge other groups, but never adds to one.
 *
 * Where more than 64 members crowd into a cube of 8 tolerances they are all linked, and with others that come
 * near the box around them: linear time for any input.
 *
 * @param positions count x 3, finite for members and obstacles
 * @param roles     a vxm_near_role per vertex
 * @param tolerance finite, at least 0; with 0 nothing is merged
 * @param map       count elements, owned by the caller
 */
vxm_status vxm_near_vertices_group(vxm_context *context, const double *positions, size_t count,
                                   const uint8_t *roles, double tolerance, uint32_t *map, vxm_error *error);

#endif
