/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The triangles that voxelization works on: polygons cut into triangles, sorted by part. They name points
 * by number; where these lie on a lattice is told by voxel/parity/snapped_points.h, so that one mesh can be
 * placed many times.
 *
 * A polygon of n corners becomes the n - 2 triangles that vxm_triangulate makes of it, as everywhere. Those
 * of one that crosses itself may overlap or run backwards; counted mod 2 they cover it exactly (2D simplicial
 * covering, Ogayar et al., section III). The inner edges cancel in pairs, so that a closed set of polygons
 * stays closed.
 *
 * Odd edges (those with an odd number of faces) get two more sets of triangles, each of which closes a part
 * mod 2:
 *  - caps, which close each loop of odd edges by triangles of its own vertices and its middle
 * (mesh/caps.h).
 *  - cones, from the apex of the part to each odd edge. The XOR of the tetrahedra from that apex to the
 * part's triangles equals the parity of triangles and cones, because the other inner faces of the tetrahedra
 * cancel.
 */
#ifndef VXM_VOXEL_PARTS_TRIANGLE_SET_H
#define VXM_VOXEL_PARTS_TRIANGLE_SET_H

#include "voxel/parts/parts.h"

typedef enum vxm_triangle_role { VXM_ROLE_FACE = 1, VXM_ROLE_CAP = 2, VXM_ROLE_CONE = 4 } vxm_triangle_role;

/** With this a set of roles holds all of them, and roles need not be looked up. */
#define VXM_ROLES_ALL 8U

/** Triangles begin..end-1 belong to a part: first those of its faces, then from `caps` on its caps, from
 * `cones` on its cones. */
typedef struct vxm_part {
  size_t begin, caps, cones, end;
} vxm_part;

/** Sums over triangles: 1, their longest edge, and its square. */
typedef struct vxm_edge_lengths {
  double count, sum, squared;
} vxm_edge_lengths;

/** Those of faces and caps together, and of cones, which few voters ask for and which are long. */
enum { VXM_LENGTHS_FACES, VXM_LENGTHS_CONES, VXM_LENGTHS_SETS };

typedef struct vxm_triangle_set {
  vxm_context *context;
  uint64_t serial; /**< no two that hold different triangles have the same */
  const vxm_soup *soup;
  uint32_t (*corners)[3]; /**< points of each triangle */
  uint32_t *part;         /**< of each triangle */
  size_t triangle_count;
  vxm_part *parts;
  uint8_t *lone; /**< of each triangle: it belongs to a lone sheet (lone_sheets.h); NULL if none does */
  /* Points: the vertices that triangles have, and the caps' own, in the order in which triangles first have
     them, so that neighbours lie close together in memory; then an apex for each part. */
  size_t first_apex, point_count;
  double (*positions)[3]; /**< of the points before first_apex, model units */
  uint32_t *vertex;       /**< of the same: the soup's vertex; a greater number is a cap's own point */
  double low[3], high[3]; /**< the box of the same */
  vxm_edge_lengths lengths[VXM_LENGTHS_SETS]; /**< model units */
  vxm_split split;                            /**< trimmed: counts only */
} vxm_triangle_set;

/** Splits a soup into parts and cuts its polygons. Destroy with vxm_triangle_set_destroy, also after a
 * failure.
 */
vxm_status vxm_triangle_set_create(vxm_triangle_set *out, const vxm_soup *soup, vxm_split_rule rule,
                                   vxm_error *error);
void vxm_triangle_set_destroy(vxm_triangle_set *triangles);

/** The point that is the apex of a part. */
static inline uint32_t vxm_apex_of(const vxm_triangle_set *triangles, size_t part) {
  return (uint32_t)(triangles->first_apex + part);
}

static inline vxm_triangle_role vxm_role_of(const vxm_triangle_set *triangles, size_t triangle) {
  const vxm_part *part = &triangles->parts[triangles->part[triangle]];
  return triangle < part->caps ? VXM_ROLE_FACE : triangle < part->cones ? VXM_ROLE_CAP : VXM_ROLE_CONE;
}

#endif
