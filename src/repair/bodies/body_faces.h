/* SPDX-License-Identifier: BSD-3-Clause */
/** The faces of bodies, and the soup that they make: each body has its own vertices. */
#ifndef VXM_REPAIR_BODIES_BODY_FACES_H
#define VXM_REPAIR_BODIES_BODY_FACES_H

#include "repair/bodies/group_rims.h"

/** A face of the soup to be made. */
typedef struct vxm_body_face {
  uint64_t body; /**< a number that says which it belongs to; 0 = it is of none and stays as it is */
  size_t face;   /**< of the soup that there is: which it is a copy of */
  bool reversed;
} vxm_body_face;

typedef struct vxm_body_faces {
  vxm_body_face *faces;
  size_t count, capacity;
} vxm_body_faces;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_body_faces_add(vxm_body_faces *list, vxm_context *context, vxm_body_face face,
                              vxm_error *error);

/**
 * Puts them in the place of the state's faces. A vertex stays with the body of the lowest number; each other
 * one gets its own at the same position, but where its group is open.
 *
 * @param[out] added how many vertices there are more
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_body_faces_build(const vxm_body_faces *list, vxm_repair_state *state,
                                const vxm_group_rims *rims, int64_t *added, vxm_error *error);

#endif
