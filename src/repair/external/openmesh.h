/* SPDX-License-Identifier: BSD-3-Clause */
/** What the module "openmesh" does: a soup taken through OpenMesh's half-edge structure. */
#ifndef VXM_REPAIR_EXTERNAL_OPENMESH_H
#define VXM_REPAIR_EXTERNAL_OPENMESH_H

#include "mesh/boundary_loops.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What the half-edge structure says of a soup. */
typedef struct vxm_halfedge_report {
  int64_t faces;    /**< that it took */
  int64_t rejected; /**< that it did not take: a third face at an edge, two that run along it alike, one that
                       closes a fan at a vertex with others, one with fewer than three corners or one twice */
  int64_t boundary_edges;
  int64_t holes;      /**< closed walks along the boundary */
  int64_t components; /**< connected by vertices; vertices without a face do not count */
  bool manifold;      /**< none was rejected and every vertex has one fan of faces */
} vxm_halfedge_report;

/** Statuses: VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED, VXM_ERROR_RANGE beyond
 * 2^30 corners. */
typedef struct vxm_openmesh {
  /** Says whether a soup is manifold, as a second opinion: closed if manifold and without boundary edges. Any
   * soup. */
  vxm_status (*inspect)(vxm_halfedge_report *out, const vxm_soup *soup, vxm_error *error);
  /**
   * Fills holes of at most max_edges edges (0 = any) without new vertices, see mesh/hole_triangulation.h. The
   * new faces are triangles, come after the others, and have the tag that most faces around the hole have.
   *
   * Faces without area are made only where there is no other way, as in a slit whose corners lie in line.
   * Holes that touch at a vertex are filled each for itself, and that vertex, which is two in a manifold, is
   * one after.
   *
   * Not filled are holes for which there is no filling without edges that exist already, and the outer rim of
   * a sheet, which filling would only cover a second time: a component is one if its vector area is at least
   * VXM_SHEET_PART of its area, and the rim is outer if its filling would face the other way.
   *
   * @param soup        manifold, or VXM_ERROR_ARGUMENT is returned
   * @param[out] origin if not NULL, a block of the soup's context: for each face of the result the face of
   *                    the soup it is; for a new one the face beyond the rim that has lent it its tag
   * @param[out] left   holes of at most max_edges edges that could not be filled
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
