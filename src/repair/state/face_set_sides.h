/* SPDX-License-Identifier: BSD-3-Clause */
/** What lies on the two sides of sets of faces: solid or not. */
#ifndef VXM_REPAIR_STATE_FACE_SET_SIDES_H
#define VXM_REPAIR_STATE_FACE_SET_SIDES_H

#include "repair/state/edge_groups.h"

enum { VXM_FACE_PLACES = 8 };

typedef struct vxm_face_set_side {
  size_t face;      /**< the face of the set that is asked */
  size_t set;       /**< for the caller */
  int place;        /**< where: 0 = its middle, up to VXM_FACE_PLACES - 1 = near one of its corners */
  bool asks_within; /**< whether `within` is to be told, which takes rays along three axes instead of one */
  bool asks_around; /**< whether `around` is to be told, where what is around it differs within its group */
  int around[2]; /**< how often other groups, not counted in `front` and `back`, wind round the points before
                    it and behind it */
  int front, back; /**< how often the faces of its group wind round the points before it (where its normal
                      points)  and behind it, as a ray to either side tells; themselves at the face passed
                      over. What winds  round all of the group is counted, too */
  bool within; /**< the group, alone or with what winds round it, bounds a solid that it lies in: by most of
                  six rays along the axes, counted with their turn where the group is balanced, else as odd or
                  even. So a wall between two voids lies within, too, as one between two rooms does */
} vxm_face_set_side;

/**
 * Asks one face of each set. Sets are put in another order: by group.
 *
 * A group may lie within the solid of others, as two voids that touch along an edge lie in a block. Where it
 * is balanced, and others that are wind round it equally often all over, as far as some of its faces tell,
 * they count as well: before those voids it is 1, and within them 0.
 *
 * @param bound per face: whether it counts
 * @param open  groups that are not balanced count around others, too: once, where most of six rays say so
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * A ray takes as long as there are faces along it: of n walls upon each other, each asked, n * n are met.
 */
vxm_status vxm_face_set_sides_find(vxm_face_set_side *sets, size_t count, vxm_repair_state *state,
                                   const vxm_edge_groups *groups, const uint8_t *bound, bool open,
                                   vxm_error *error);

#endif
