/* SPDX-License-Identifier: BSD-3-Clause */
/** Vertex grouping: the connected components of a soup. */
#ifndef VXM_MESH_COMPONENTS_H
#define VXM_MESH_COMPONENTS_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Labels every vertex with the lowest vertex that faces connect it to, by minimum-label propagation
 * (Chen & Tu, sec. 2.1) with pointer jumping.
 *
 * @param vertex_map vertex to take in place of each vertex (as from vxm_weld_exact; map[map[v]] = map[v]), or
 *                   NULL
 * @param labels     vertex_count elements, owned by the caller; with a map only labels[map[v]] has a meaning
 * @param rounds     rounds that were needed, the last one without a change; may vary with the threads, while
 *                   the labels do not; may be NULL
 * @return VXM_OK, VXM_ERROR_CANCELLED
 */
vxm_status vxm_group_vertices(vxm_context *context, const vxm_soup *soup, const uint32_t *vertex_map,
                              uint32_t *labels, int *rounds, vxm_error *error);

/**
 * Numbers the components 0..count-1 in the order of their first face and says which one each face is in.
 *
 * Faces are connected by the vertices they share, after mapping; vertices without a face do not count, and a
 * face without corners is a component of its own.
 *
 * @param face_labels face_count elements, owned by the caller; may be NULL
 * @return VXM_OK, VXM_ERROR_RANGE beyond 2^32 - 1 components, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_components(vxm_context *context, const vxm_soup *soup, const uint32_t *vertex_map,
                          uint32_t *face_labels, size_t *count, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
