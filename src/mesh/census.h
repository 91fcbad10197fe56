/* SPDX-License-Identifier: BSD-3-Clause */
/** The census: statistics of a soup, and counts of its defects. */
#ifndef VXM_MESH_CENSUS_H
#define VXM_MESH_CENSUS_H

#include "mesh/unit_scale.h"

/**
 * Takes the census of a soup (vxm_mesh_census).
 *
 * Vertices are taken by position, that is after vxm_weld_exact, except for components_raw. In detail:
 *  - Faces of vertices that are not finite count as faces, and in their component; to all else they are gone,
 * as repair removes them: their neighbours have open edges.
 *  - degenerate_faces: fewer than three distinct corners, or no area (vxm_unit_scale_no_area).
 *  - Faces with fewer than three distinct corners have no edges and are no duplicates of each other. Faces
 *    without area but with three distinct corners do and are, as they may be what keeps a mesh closed.
 *  - duplicate_faces, opposite_duplicate_faces: as `same` and `opposite_pairs` of vxm_duplicates. Two faces
 * of each orientation at one place count 2 and 2.
 *  - boundary_edges, nonmanifold_edges: edges with one side, with more than two sides; a polygon that passes
 *    an edge twice has two sides there. inconsistent_edges: two sides in the same direction.
 *  - components: all faces, also degenerate ones.
 *  - nonfinite_vertices, unused_vertices: of all vertices, by number.
 *  - bounds: of the finite vertices of faces.
 *  - area, volume: what is not finite adds nothing; a result beyond a double is clamped to the largest one.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED; *out is zero after a failure
 */
vxm_status vxm_soup_census(vxm_census *out, const vxm_soup *soup, vxm_error *error);

#endif
