/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces that are to take the place of those of a soup under repair, with what is known of each. */
#ifndef VXM_REPAIR_STATE_FACE_LIST_H
#define VXM_REPAIR_STATE_FACE_LIST_H

#include "repair/state/repair_state.h"

typedef struct vxm_face_list {
  uint64_t *offsets;
  uint32_t *indices, *tags, *parts;
  uint8_t *turned;
  size_t count, corners;
} vxm_face_list;

/** Makes room for so many faces and corners. @param[out] out freed with vxm_face_list_destroy, also after a
 * failure */
vxm_status vxm_face_list_create(vxm_face_list *out, vxm_repair_state *state, size_t faces, size_t corners,
                                vxm_error *error);
void vxm_face_list_destroy(vxm_face_list *list, vxm_repair_state *state);
/** Adds a face that is (a piece of) one of the soup. */
void vxm_face_list_put(vxm_face_list *list, const vxm_repair_state *state, size_t face,
                       const uint32_t *corner, size_t corners);
/** The faces become those of the soup; the list takes the old ones, to be freed. */
void vxm_face_list_exchange(vxm_face_list *list, vxm_repair_state *state);

#endif
