/* SPDX-License-Identifier: BSD-3-Clause */
/** Exact welding: which vertices share a position, bit for bit. */
#ifndef VXM_MESH_WELD_H
#define VXM_MESH_WELD_H

#include "base/context.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Maps every vertex to the lowest vertex of the same position.
 *
 * Positions are the same if all coordinates have the same bits, with -0.0 taken as 0.0; a vertex with a NaN
 * is mapped to itself. So map[v] <= v and map[map[v]] = map[v].
 *
 * @param positions count x 3
 * @param count     at most VXM_VERTICES_MAX
 * @param map       count elements, owned by the caller
 * @param distinct  number of vertices that map to themselves; may be NULL
 */
vxm_status vxm_weld_exact(vxm_context *context, const double *positions, size_t count, uint32_t *map,
                          size_t *distinct, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
