/* SPDX-License-Identifier: BSD-3-Clause */
/** Tolerant welding to the end: no two of the vertices that are left are near each other. */
#ifndef VXM_MESH_VERTEX_NET_H
#define VXM_MESH_VERTEX_NET_H

#include "base/context.h"

/**
 * Merges what vxm_near_vertices_group leaves alone: chains and crowds of vertices, wider than the tolerance.
 *
 * In their order, each vertex that none before it that stays is near to stays too; the others go to the
 * nearest one that stays, or the first of several. So
 *  - no two vertices that stay are within the tolerance of each other: doing it again does nothing;
 *  - each of the others was within the tolerance of the one it goes to;
 *  - vertices that nothing else is near to, such as the groups that were merged before, stay as they are.
 *
 * Linear time for any input.
 *
 * @param positions count x 3, finite for members
 * @param members   whether a vertex takes part
 * @param map       in and out: of a vertex that was merged, the one it went to, and of all others themselves;
 *                  only the latter take part
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_vertex_net(vxm_context *context, const double *positions, size_t count, const uint8_t *members,
                          double tolerance, uint32_t *map, vxm_error *error);

#endif
