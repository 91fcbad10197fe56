/* SPDX-License-Identifier: BSD-3-Clause */
/** The census of each part of a soup. */
#ifndef VXM_MESH_PART_CENSUS_H
#define VXM_MESH_PART_CENSUS_H

#include "mesh/soup.h"

/**
 * Measures parts, after welding identical positions. An edge that has faces of several parts after welding
 * counts for the first of them. Self-intersections are left at -1.
 *
 * @param out        part_count elements
 * @param face_parts per face: its part
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_part_census_all(vxm_part_state *out, size_t part_count, const vxm_soup *soup,
                               const uint32_t *face_parts, vxm_error *error);

#endif
