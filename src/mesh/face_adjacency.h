/* SPDX-License-Identifier: BSD-3-Clause */
/** Which face lies across each side of a face. */
#ifndef VXM_MESH_FACE_ADJACENCY_H
#define VXM_MESH_FACE_ADJACENCY_H

#include "mesh/side_table.h"

/** No side, as from a corner to one at the same vertex. */
#define VXM_NO_ADJACENT UINT32_MAX

/**
 * Pairs the sides where that is all there is to it: each edge has two, which run opposite ways.
 *
 * @param[out] adjacent per corner the face across the side that begins there, or VXM_NO_ADJACENT; a block of
 *                      the table's context. NULL where there is any other edge
 * @param table         of the soup; sides change places within those of the same vertex and direction
 * @return VXM_OK; VXM_ERROR_RANGE beyond 2^32 - 2 faces; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_face_adjacency_build(uint32_t **adjacent, vxm_side_table *table, const vxm_soup *soup,
                                    vxm_error *error);

#endif
