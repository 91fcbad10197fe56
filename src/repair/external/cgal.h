/* SPDX-License-Identifier: BSD-3-Clause */
/** What the module "cgal" does: repair that needs exact geometry. Its own files are GPL-3.0-or-later, as
 * CGAL's are. */
#ifndef VXM_REPAIR_EXTERNAL_CGAL_H
#define VXM_REPAIR_EXTERNAL_CGAL_H

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
  int64_t united; /**< those of them that were joined with another one, or lay inside one */
  int64_t cut;    /**< of the others, those that were cut where they meet themselves or touch another */
  int64_t failed; /**< those that should have been changed, but are in the result as they were */
  uint64_t *
      failed_faces; /**< one face of the input for each failed part; a block of the soup's context, or NULL */
} vxm_union_report;

/** How parts are united. */
typedef struct vxm_union_options {
  bool outward_only;     /**< what a part winds round the other way is left out */
  bool single_precision; /**< the surface has to be right in 32-bit floats, for a file that holds such */
} vxm_union_options;

/**
 * All take soups whose positions are finite, and count the memory of CGAL against the context's limit.
 * `origin`, where it is not NULL, gets a block of the soup's context with, for each face of the result, the
 * face of the input it is (a piece of), or VXM_NO_FACE. Statuses: VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED, VXM_ERROR_RANGE, and VXM_ERROR_ARGUMENT where the input is not
 * as said.
 */
typedef struct vxm_cgal {
  /**
   * Finds at most `most` pairs, the same ones each time. Any soup; polygons by the triangles they are split
   * into. Corners are shared where their positions are the same, so two faces with the same corners are a
   * pair, and two that only touch along a common edge are none. Faces without area take no part.
   */
  vxm_status (*self_intersections)(vxm_face_pairs *out, const vxm_soup *soup, size_t most, vxm_error *error);
  /**
   * Fills holes with at most max_edges edges (0 = any) with triangles that are refined to the density of the
   * rim and faired to continue it smoothly; where these would run through the surface, with triangles that
   * are refined only, or else with triangles between the corners of the rim. Old faces and vertices come
   * first, as they were. A hole stays, and is counted in *left, if its rim passes a position twice, if the
   * faces at it do not agree, if it is longer than 10000 edges, or if its filling would lie on the faces
   * around it: a sheet.
   */
  vxm_status (*fill)(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                     size_t max_edges, vxm_error *error);
  /**
   * Unites the closed components of a soup (those whose edges are passed as often in one direction as in the
   * other) into the surface of their union. The others, and those without a volume, stay as they are.
   *
   * A component that is wound outward is solid where it winds around a place, in whichever direction: what
   * runs through itself loses nothing. But what it winds round inward is left out if that is no more than a
   * thousandth of it, or with outward_only. One that is wound inward is a cavity of a solid that it lies
   * inside of without touching it: the smallest, or where that has a cavity that may overlap it another one
   * (mesh/voids.h). Where there is none it is one of those that it lies inside of and touches, but for a
   * ten-thousandth of it; where these are none, too, it is subtracted from all that it touches but from those
   * that lie in it; where it touches nothing it is left as it is and counted as failed, or, no thicker than
   * 2^-22 of the largest coordinate, left out: rounding has turned it over. What a union leaves of components
   * is left out, too, where it is no thicker and they were.
   *
   * The surface is cut exactly and then rounded to doubles, or 32-bit floats; no two of its faces meet
   * elsewhere than in corners and edges they share, and none is without area. Where the numbers cannot hold
   * that, the parts concerned are put on a lattice first, of up to 2^-22 times the largest coordinate or, in
   * floats, 2^-17. Where the union touches itself, there are several vertices at one position, so that every
   * edge has two faces; but four where the material is joined around both ends of it, which
   * vxm_cut_nonmanifold parts. Components that touch nothing keep their faces and vertices, and come in the
   * order of their faces.
   */
  vxm_status (*unite)(vxm_soup **out, uint64_t **origin, vxm_union_report *report, const vxm_soup *soup,
                      const vxm_union_options *options, vxm_error *error);
  /**
   * Turns the closed components of a soup so that together they bound a volume: outward, but against the
   * smallest one around that they do not touch. The others stay as they are. *turned counts faces.
   */
  vxm_status (*orient)(vxm_soup **out, int64_t *turned, const vxm_soup *soup, vxm_error *error);
  /**
   * A closed, oriented, 2-manifold surface around any soup: alpha and offset in model units, both > 0. Also
   * VXM_ERROR_EMPTY if no face has an area, and VXM_ERROR_MEMORY_LIMIT, before anything is done, if the size
   * of the result can be told to be too large; the message says how much larger an alpha would fit. Here
   * `origin` is the face of the input that lies nearest to the middle of each face.
   */
  vxm_status (*wrap)(vxm_soup **out, uint64_t **origin, const vxm_soup *soup, double alpha, double offset,
                     vxm_error *error);
} vxm_cgal;

#define VXM_NO_FACE UINT64_MAX

/** Opens the module. @param purpose such as "--wrap" @return VXM_OK, VXM_ERROR_UNAVAILABLE */
vxm_status vxm_cgal_open(const vxm_cgal **out, const char *purpose, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
