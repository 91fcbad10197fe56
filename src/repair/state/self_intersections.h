/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces that cut through each other, found by the module for CGAL. */
#ifndef VXM_REPAIR_STATE_SELF_INTERSECTIONS_H
#define VXM_REPAIR_STATE_SELF_INTERSECTIONS_H

#include "repair/external/cgal.h"

/** Pairs that are counted at most; a mesh with more is a heap of faces. */
enum { VXM_CROSSINGS_MOST = VXM_SELF_INTERSECTIONS_MAX };

/**
 * Finds at most `most` pairs. Faces with a vertex that is not finite take no part.
 *
 * @param[out] out its pairs are a block of the soup's context; empty after a failure
 * @return VXM_OK, VXM_ERROR_UNAVAILABLE, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
vxm_status vxm_self_intersections_find(vxm_face_pairs *out, const vxm_soup *soup, size_t most,
                                       vxm_error *error);

/**
 * Counts pairs, up to VXM_CROSSINGS_MOST.
 *
 * @param states     one for each part, whose self_intersections are set; or NULL. A pair of faces of two
 * parts counts for both
 * @param face_parts per face: its part; not used without `states`
 */
vxm_status vxm_self_intersections_count(int64_t *total, vxm_part_state *states, size_t part_count,
                                        const uint32_t *face_parts, const vxm_soup *soup, vxm_error *error);

#endif
