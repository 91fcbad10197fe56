/* SPDX-License-Identifier: BSD-3-Clause */
/** Between which winding numbers the faces of closed surfaces lie. */
#ifndef VXM_REPAIR_BODIES_LAYERS_H
#define VXM_REPAIR_BODIES_LAYERS_H

#include "mesh/duplicate_faces.h"
#include "repair/state/edge_groups.h"

/** What is known of the faces, and what is found. */
typedef struct vxm_layers {
  vxm_repair_state *state;
  const vxm_copies *copies;
  const vxm_edge_groups *groups;
  const uint8_t *asked; /**< per group: it is balanced, and to be looked at */
  /* Faces of one orientation that go on over edges where only two kinds meet are a patch: on each side of it
     the winding number is one and the same, unless another face cuts through it. */
  size_t
      *patch; /**< per face that stands for its kind: another one of its patch, or itself; see vxm_set_of */
  int64_t *front; /**< per face that stands for a patch: the winding number where its normals point, of its
                     group and of what lies around all of that. Behind it is more by vxm_layers_surplus.
                     The same per sheet */
  bool *known;    /**< the same: `front` is */
  bool *cut;      /**< the same: it is not the same all over the patch, as other faces cut through it */
} vxm_layers;

/** How many more of its kind run as this face does than the other way. */
static inline int64_t vxm_layers_surplus(const vxm_layers *layers, size_t face) {
  return (int64_t)layers->copies[face].same - (int64_t)layers->copies[face].opposite;
}

/** Whether a face stands for its kind: the first one of the orientation that most have. None does for a
 * sheet, which has as many of both. */
static inline bool vxm_layers_stands(const vxm_layers *layers, size_t face) {
  return vxm_layers_surplus(layers, face) > 0 && layers->copies[face].rank == 0;
}

/** Whether a sheet lies within what the faces wind round, on both its sides. */
static inline bool vxm_layers_hides(const vxm_layers *layers, size_t face) {
  size_t first = layers->copies[face].first;
  return layers->known[first] && layers->front[first] != 0;
}

/**
 * Finds the winding numbers beside the patches of the groups that are asked for. A ray from a face of each
 * tells them; where another face lies upon it, or they do not differ as they should, they follow from what
 * the edges of other patches lack (repair/bodies/layer_balance.c).
 *
 * @param layers `patch`, `front`, `known` and `cut` have room for face_count elements and are filled
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_layers_find(vxm_layers *layers, vxm_error *error);

/**
 * Chooses the layers of the patches that are not known such that each layer is closed, as far as that goes:
 * always for the patch next whose edges are fitted best, between the winding numbers that its ray has met.
 *
 * @param reach per face that stands for a patch, twice: the least and the greatest winding number to choose
 * from
 */
vxm_status vxm_layers_balance(vxm_layers *layers, const int32_t *reach, vxm_error *error);

#endif
