/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces that lie on each other along an edge that they share. */
#ifndef VXM_REPAIR_STATE_FLAT_FOLD_H
#define VXM_REPAIR_STATE_FLAT_FOLD_H

#include "mesh/edges.h"
#include "mesh/geometry.h"

/** A side of a face along an edge. */
typedef struct vxm_edge_side {
  uint32_t edge;
  bool forward; /**< runs from the lower to the higher vertex */
  size_t face;
} vxm_edge_side;

/** Into which direction a face leaves the edge, of any length. */
static inline vxm_vec3 vxm_leaves_edge(const vxm_soup *soup, const vxm_edge *edge, const vxm_edge_side *side,
                                       double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, side->face, &count);
  const double *from = vxm_position(soup, side->forward ? edge->a : edge->b);
  const double *to = vxm_position(soup, side->forward ? edge->b : edge->a);
  return vxm_vec3_cross(vxm_polygon_area(soup->positions, corner, count, scale),
                        vxm_vec3_between(to, from, scale));
}

/** Whether two vectors point the same way, but for the angle that rounding makes. */
static inline bool vxm_are_parallel(vxm_vec3 u, vxm_vec3 v) {
  const double angle_max = 1e-4;
  double along = vxm_vec3_dot(u, v);
  return along > 0 && vxm_vec3_length(vxm_vec3_cross(u, v)) <= angle_max * along;
}

/** Whether two faces at an edge lie on each other, folded flat. */
static inline bool vxm_is_flat_fold(const vxm_soup *soup, const vxm_edge *edge, const vxm_edge_side *one,
                                    const vxm_edge_side *other, double scale) {
  return vxm_are_parallel(vxm_leaves_edge(soup, edge, one, scale), vxm_leaves_edge(soup, edge, other, scale));
}

#endif
