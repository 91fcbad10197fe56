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

/** Vector areas of all faces (vxm_polygon_area), the caller's to free with vxm_free: of large polygons they
 * would be added up for each edge. @return NULL after a failure */
static inline vxm_vec3 *vxm_face_areas(vxm_context *context, const vxm_soup *soup, double scale,
                                       vxm_error *error) {
  vxm_vec3 *areas = vxm_alloc(context, soup->face_count, sizeof *areas, error);
  for (size_t f = 0; areas && f < soup->face_count; f++)
    areas[f] = vxm_face_area(soup, f, scale);
  return areas;
}

/** Into which direction a face leaves the edge, of any length. @param areas vxm_face_areas */
static inline vxm_vec3 vxm_leaves_edge(const vxm_soup *soup, const vxm_edge *edge, const vxm_edge_side *side,
                                       const vxm_vec3 *areas, double scale) {
  const double *from = vxm_position(soup, side->forward ? edge->a : edge->b);
  const double *to = vxm_position(soup, side->forward ? edge->b : edge->a);
  return vxm_vec3_cross(areas[side->face], vxm_vec3_between(to, from, scale));
}

/** Whether two vectors point the same way, but for the angle that rounding makes. */
static inline bool vxm_are_parallel(vxm_vec3 u, vxm_vec3 v) {
  const double angle_max = 1e-4;
  double along = vxm_vec3_dot(u, v);
  return along > 0 && vxm_vec3_length(vxm_vec3_cross(u, v)) <= angle_max * along;
}

/** Whether two faces at an edge lie on each other, folded flat. */
static inline bool vxm_is_flat_fold(const vxm_soup *soup, const vxm_edge *edge, const vxm_edge_side *one,
                                    const vxm_edge_side *other, const vxm_vec3 *areas, double scale) {
  return vxm_are_parallel(vxm_leaves_edge(soup, edge, one, areas, scale),
                          vxm_leaves_edge(soup, edge, other, areas, scale));
}

#endif
