/* SPDX-License-Identifier: BSD-3-Clause */
/** What the module "cgal" does: repair that needs exact geometry. Its own files are GPL-3.0-or-later, as
 * CGAL's are. */
#ifndef VXM_REPAIR_CGAL_H
#define VXM_REPAIR_CGAL_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Two faces that meet elsewhere than in the corners and edges they share; first < second. */
typedef struct vxm_face_pair {
  uint64_t first, second;
} vxm_face_pair;

/** Pairs in increasing order; `pairs` is a block of the soup's context. */
typedef struct vxm_face_pairs {
  vxm_face_pair *pairs;
  size_t count;  /**< found and listed */
  bool complete; /**< false: there are more than were asked for */
} vxm_face_pairs;

typedef struct vxm_union_report {
  int64_t parts;  /**< closed components that came in */
  int64_t united; /**< of them, those that were joined with another one, or lay inside one */
  int64_t failed; /**< those that could not be (they cut through themselves): they are in the result as they
                     were */
  uint64_t *
      failed_faces; /**< one face of the input for each failed part; a block of the soup's context, or NULL */
} vxm_union_report;

/**
 * All take soups whose positions are finite. `origin`, where it is not NULL, gets a block of the soup's
 * context with, for each face of the result, the face of the input it is (a piece of), or VXM_NO_FACE.
 * Statuses: VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED, VXM_ERROR_RANGE, and
 * VXM_ERROR_ARGUMENT where the input is not as said.
 */
typedef struct vxm_cgal {
  /** Finds at most `most` pairs. Any soup; polygons by the triangles they are split into. */
  vxm_status (*self_intersections)(vxm_face_pairs *out, const vxm_soup *soup, size_t most, vxm_error *error);
  /**
   * Fills holes with at most max_edges edges (0 = any) with triangles that are refined to the density of the
   * rim and faired to continue it smoothly. A manifold soup; a hole that cannot be filled stays and is
   * counted in *left.
   */
  vxm_status (*fill)(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                     size_t max_edges, vxm_error *error);
  /**
   * Unites the closed components of a closed manifold soup into the surface of their union (corefinement);
   * components that are wound inward are cavities and are subtracted. Part by part: one that cannot be united
   * stays as it was.
   */
  vxm_status (*unite)(vxm_soup **out, uint64_t **origin, vxm_union_report *report, const vxm_soup *soup,
                      vxm_error *error);
  /** Turns the components of a closed manifold soup so that together they bound a volume. `turned` counts
   * faces. */
  vxm_status (*orient)(vxm_soup **out, int64_t *turned, const vxm_soup *soup, vxm_error *error);
  /** A closed, oriented, 2-manifold surface that encloses any soup: alpha and offset in model units, both >
   * 0. */
  vxm_status (*wrap)(vxm_soup **out, const vxm_soup *soup, double alpha, double offset, vxm_error *error);
} vxm_cgal;

#define VXM_NO_FACE UINT64_MAX

/** Opens the module. @param purpose such as "--wrap" @return VXM_OK, VXM_ERROR_UNAVAILABLE */
vxm_status vxm_cgal_open(const vxm_cgal **out, const char *purpose, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
