/* SPDX-License-Identifier: BSD-3-Clause */
/** What lies on the two sides of sets of faces: solid or not. */
#ifndef VXM_REPAIR_STATE_FACE_SET_SIDES_H
#define VXM_REPAIR_STATE_FACE_SET_SIDES_H

#include "repair/state/edge_groups.h"

typedef struct vxm_face_set_side {
  size_t face;      /**< the face of the set that is asked */
  size_t set;       /**< for the caller */
  bool asks_within; /**< whether `within` is to be told, which takes rays along three axes instead of one */
  int front,
      back;    /**< how often the faces of its group wind round the points before it (where its normal points)
                  and behind it, as a ray to either side tells; themselves at the face passed over */
  bool within; /**< the group bounds a solid that it lies in: by most of six rays along the axes, counted with
                  their turn where the group is balanced, else as odd or even */
} vxm_face_set_side;

/**
 * Asks one face of each set. Sets are put in another order: by group.
 *
 * @param bound per face: whether it counts
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * A ray takes as long as there are faces along it: of n walls upon each other, each asked, n * n are met.
 */
vxm_status vxm_face_set_sides_find(vxm_face_set_side *sets, size_t count, vxm_repair_state *state,
                                   const vxm_edge_groups *groups, const uint8_t *bound, vxm_error *error);

#endif
