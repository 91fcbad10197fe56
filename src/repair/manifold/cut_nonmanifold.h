/* SPDX-License-Identifier: BSD-3-Clause */
/** A soup made manifold by giving every fan of faces a vertex of its own. */
#ifndef VXM_REPAIR_MANIFOLD_CUT_NONMANIFOLD_H
#define VXM_REPAIR_MANIFOLD_CUT_NONMANIFOLD_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Joins sides into fans and stitches rims (repair/manifold/halfedge_pairing.h). Faces keep their order,
 * corners and tags; vertices keep their numbers, except that those which stitching empties are left out;
 * further fans of a vertex follow at the end, at its position.
 *
 * @param[out] split    vertices added
 * @param[out] stitched edges joined by position
 * @return as vxm_halfedge_pairing_build, and VXM_ERROR_RANGE beyond VXM_VERTICES_MAX
 */
vxm_status vxm_cut_nonmanifold(vxm_soup **out, int64_t *split, int64_t *stitched, const vxm_soup *soup,
                               vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
