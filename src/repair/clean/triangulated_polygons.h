/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons of which only the triangles are left that they were cut into. */
#ifndef VXM_REPAIR_CLEAN_TRIANGULATED_POLYGONS_H
#define VXM_REPAIR_CLEAN_TRIANGULATED_POLYGONS_H

#include "mesh/geometry.h"
#include "repair/state/repair_state.h"

/** Triangles that go on over edges with two sides. */
typedef struct vxm_triangulated {
  size_t triangles, border; /**< how many, and of the sides how many are on the border */
  uint64_t hash;            /**< of the edges there, whatever their order */
  bool rimmed;              /**< one of those has no more than two sides */
  bool mixed;               /**< its triangles have several tags */
  /* What vxm_polygons_measure tells: */
  vxm_vec3 area;
  bool bent;  /**< a triangle points elsewhere */
  bool plane; /**< all lie in one plane */
} vxm_triangulated;

typedef struct vxm_polygons {
  vxm_repair_state *state;
  size_t *triangles; /**< faces that may be of polygons all of whose edges have more than two sides, in order;
                        what follows is per place in there */
  size_t triangle_count;
  size_t *across;             /**< per side: the triangle there, or SIZE_MAX on a border */
  size_t *parent;             /**< another one of its polygon, or itself; see vxm_set_of */
  vxm_triangulated *polygons; /**< of those that stand for one; NULL = there are no two */
} vxm_polygons;

/** Needs the state's edge map. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED;
 * to be destroyed in any case */
vxm_status vxm_polygons_find(vxm_polygons *out, vxm_repair_state *state, vxm_error *error);
void vxm_polygons_destroy(vxm_polygons *polygons);

/** Looks which are nearly plane, and which are plane; positions are multiplied by `scale`. */
void vxm_polygons_measure(vxm_polygons *polygons, double scale);

/** Whether it is one: it is nearly plane as far as that is known, and no vertex is elsewhere than on the
 * border, which then has two sides more than there are triangles, as these hang together like a tree. */
static inline bool vxm_is_polygon(const vxm_triangulated *p) {
  return p->triangles > 1 && p->border == p->triangles + 2 && !p->rimmed && !p->bent;
}

/** Whether two with the same border may be one polygon that is there twice; `turn` is -1 where the second is
 * turned over, else 1. Front and back of what is drawn from both sides may be a little bent, while of two
 * surfaces that look the same way one may be meant to lie behind the other. */
bool vxm_polygons_may_be_one(const vxm_triangulated *p, const vxm_triangulated *q, int turn);

#endif
