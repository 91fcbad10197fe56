/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The triangles that voxelization works on: polygons covered by triangles, sorted by part, on the lattice.
 *
 * A polygon of n corners becomes the n - 2 triangles from one of its corners to its edges. They may overlap
 * or run backwards; counted mod 2 they cover the polygon exactly (2D simplicial covering, Ogayar et al.,
 * section III, with the apex in a corner). The inner edges cancel in pairs, so that a closed set of polygons
 * stays closed.
 *
 * An open part also gets its cones: the triangles from the part's apex to each odd edge (one with an odd
 * number of incident faces). Part and cones together are closed mod 2, and the XOR of the part's tetrahedra
 * with that apex equals the parity of part and cones, because the other inner faces of the tetrahedra cancel
 * in pairs.
 */
#ifndef VXM_VOXEL_FACETS_H
#define VXM_VOXEL_FACETS_H

#include "voxel/lattice.h"

typedef struct vxm_facet {
  uint32_t corner[3]; /**< into points; a cone has its apex in corner[2] */
  uint32_t part;
} vxm_facet;

/** Box of a part in lattice coordinates, without its apex; low > high for a part without triangles. */
typedef struct vxm_part {
  vxm_point low, high;
  uint32_t apex;     /**< point: the mean of the corners of the part's triangles (Rueda et al., section 3) */
  size_t begin, end; /**< its facets, cones included */
  size_t odd_edges;  /**< 0 = closed mod 2 */
} vxm_part;

typedef struct vxm_facets {
  vxm_context *context;
  vxm_point *points; /**< the soup's vertices, then one apex per part */
  size_t first_apex;
  vxm_facet *facets; /**< part after part; in each the triangles first, then the cones */
  size_t facet_count;
  vxm_part *parts;
  size_t part_count;
  size_t closed_count;   /**< parts closed mod 2: they come first */
  size_t odd_edge_count; /**< in all parts together */
} vxm_facets;

static inline bool vxm_facet_is_cone(const vxm_facets *facets, size_t f) {
  return facets->facets[f].corner[2] >= facets->first_apex;
}

/** Splits a soup into parts and covers its polygons. Destroy with vxm_facets_destroy. */
vxm_status vxm_facets_create(vxm_facets *out, const vxm_soup *soup, const vxm_lattice *lattice,
                             vxm_parts split, vxm_error *error);
void vxm_facets_destroy(vxm_facets *facets);

#endif
