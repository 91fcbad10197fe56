/* SPDX-License-Identifier: BSD-3-Clause */
/** The sides of faces that meet along one edge, and which two of them bound a wedge of the solid. */
#ifndef VXM_REPAIR_MANIFOLD_RADIAL_SORT_H
#define VXM_REPAIR_MANIFOLD_RADIAL_SORT_H

#include "mesh/soup.h"

#define VXM_NO_SIDE UINT32_MAX

typedef struct vxm_radial_side {
  uint32_t side; /**< corner of the soup that the side starts from */
  uint32_t face;
  uint32_t group;   /**< sides of one group, such as a patch of faces, are joined with each other first */
  bool forward;     /**< runs from the first to the second end of the edge */
  uint32_t partner; /**< set: the side across the wedge, or VXM_NO_SIDE */
  double angle;     /**< set: of the face about the edge */
  uint32_t rank;    /**< set: in the order around the edge; faces that lie upon each other have the same */
  uint32_t below;   /**< scratch */
} vxm_radial_side;

/**
 * Sorts the sides of an edge by the angles of their faces, counterclockwise as seen from its second end; of
 * faces that lie upon each other those with forward sides come first.
 *
 * @param from, to, scale as below
 */
void vxm_radial_sort_order(vxm_radial_side *sides, size_t count, const vxm_soup *soup, const double *from,
                           const double *to, double scale);

/**
 * Pairs the sides of an edge, each with one that runs the other way. Faces turn their backs to the solid, so
 * going around the edge a wedge of it begins with a backward and ends with a forward side; the pairs nest as
 * brackets do. A group with as many sides in each direction keeps to itself: it is closed along this edge.
 * As many sides find a partner as can. Sorts the sides; the pairs do not depend on their order before.
 *
 * @param from, to the ends of the edge
 * @param scale    a power of two that brings the soup to about unit size
 */
void vxm_radial_sort_match(vxm_radial_side *sides, size_t count, const vxm_soup *soup, const double *from,
                           const double *to, double scale);

#endif
