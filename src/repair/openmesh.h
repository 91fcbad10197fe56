/* SPDX-License-Identifier: BSD-3-Clause */
/** What the module "openmesh" does: a soup taken through OpenMesh's half-edge structure. */
#ifndef VXM_REPAIR_OPENMESH_H
#define VXM_REPAIR_OPENMESH_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What the half-edge structure says of a soup. */
typedef struct vxm_halfedge_report {
  int64_t faces;    /**< that it took */
  int64_t rejected; /**< that it did not take: a third face at an edge, two that run along it alike, a vertex
                       of two fans */
  int64_t boundary_edges;
  int64_t holes; /**< closed walks along the boundary */
  int64_t components;
  bool manifold; /**< none was rejected and every vertex has one fan of faces */
} vxm_halfedge_report;

/** `origin` as in repair/cgal.h. Statuses: VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED, VXM_ERROR_RANGE. */
typedef struct vxm_openmesh {
  /** Says whether a soup is manifold, as a second opinion. Faces have at least three corners, all different.
   */
  vxm_status (*inspect)(vxm_halfedge_report *out, const vxm_soup *soup, vxm_error *error);
  /**
   * Makes a soup manifold: faces are taken in one after another, first those that continue a patch; what the
   * structure rejects is detached, on vertices of its own at the same positions, and kept; then rims that lie
   * upon each other, edge by edge in opposite directions, are stitched where that stays manifold. No face is
   * lost.
   */
  vxm_status (*separate)(vxm_soup **out, uint64_t **origin, int64_t *detached, int64_t *stitched,
                         const vxm_soup *soup, vxm_error *error);
  /**
   * Fills holes of at most max_edges edges (0 = any) of a manifold soup by the triangulation of their rim
   * with the least area (and the least sharp angle between triangles; Liepa 2003), without new vertices. What
   * cannot be filled so stays and is counted.
   */
  vxm_status (*fill)(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                     size_t max_edges, vxm_error *error);
} vxm_openmesh;

/** Opens the module. @return VXM_OK, VXM_ERROR_UNAVAILABLE */
vxm_status vxm_openmesh_open(const vxm_openmesh **out, const char *purpose, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
