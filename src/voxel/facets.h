/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The triangles that voxelization works on: polygons covered by triangles, sorted by part, on the lattice.
 *
 * A polygon of n corners becomes the n - 2 triangles from one of its corners to its edges. They may overlap
 * or run backwards; counted mod 2 they cover the polygon exactly (2D simplicial covering, Ogayar et al.,
 * section III, with the apex in a corner). The inner edges cancel in pairs, so that a closed set of polygons
 * stays closed.
 *
 * Odd edges (those with an odd number of faces) get two more sets of triangles, each of which closes a part
 * mod 2:
 *  - cones, from the apex of the part to each odd edge. The XOR of the tetrahedra from that apex to the
 * part's triangles equals the parity of triangles and cones, because the other inner faces of the tetrahedra
 * cancel.
 *  - caps, which close each loop of odd edges by triangles of its own vertices and its middle
 * (repair/caps.h).
 */
#ifndef VXM_VOXEL_FACETS_H
#define VXM_VOXEL_FACETS_H

#include "voxel/parts.h"

typedef enum vxm_facet_role { VXM_FACET_TRIANGLE = 1, VXM_FACET_CONE = 2, VXM_FACET_CAP = 4 } vxm_facet_role;

typedef struct vxm_facet {
  uint32_t corner[3]; /**< into points */
  uint32_t part;
  vxm_facet_role role;
} vxm_facet;

/** Box of a part in lattice coordinates; low > high for a part without triangles. */
typedef struct vxm_part {
  vxm_point low, high; /**< of its triangles; apexes lie inside */
  uint32_t apex;     /**< point: the mean of the corners of the part's triangles (Rueda et al., section 3) */
  size_t begin, end; /**< its facets of all roles */
} vxm_part;

typedef struct vxm_facets {
  vxm_context *context;
  vxm_point *points; /**< the soup's vertices, then an apex per part, then the caps' own points */
  size_t first_apex, first_cap;
  vxm_facet *facets; /**< part after part; in each the triangles first, then the cones and the caps */
  size_t facet_count;
  vxm_part *parts;
  vxm_split split;
} vxm_facets;

/** Splits a soup into parts and covers its polygons. Destroy with vxm_facets_destroy, also after a failure.
 */
vxm_status vxm_facets_create(vxm_facets *out, const vxm_soup *soup, const vxm_lattice *lattice,
                             vxm_split_rule rule, vxm_error *error);
void vxm_facets_destroy(vxm_facets *facets);

#endif
