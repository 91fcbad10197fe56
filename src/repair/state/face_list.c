/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/face_list.h"

vxm_status vxm_face_list_create(vxm_face_list *out, vxm_repair_state *state, size_t faces, size_t corners,
                                vxm_error *error) {
  const vxm_soup *soup = state->soup;
  vxm_status status = VXM_OK;
  *out = (vxm_face_list){0};
  out->offsets = vxm_repair_state_scratch(state, faces + 1, sizeof *out->offsets, &status, error);
  if (status == VXM_OK)
    out->indices = vxm_repair_state_scratch(state, corners, sizeof *out->indices, &status, error);
  if (status == VXM_OK && soup->face_tags)
    out->tags = vxm_repair_state_scratch(state, faces, sizeof *out->tags, &status, error);
  if (status == VXM_OK && soup->face_parts)
    out->parts = vxm_repair_state_scratch(state, faces, sizeof *out->parts, &status, error);
  if (status == VXM_OK && state->turned)
    out->turned = vxm_repair_state_scratch(state, faces, sizeof *out->turned, &status, error);
  return status;
}

void vxm_face_list_destroy(vxm_face_list *list, vxm_repair_state *state) {
  vxm_free(state->context, list->turned);
  vxm_free(state->context, list->parts);
  vxm_free(state->context, list->tags);
  vxm_free(state->context, list->indices);
  vxm_free(state->context, list->offsets);
}

void vxm_face_list_put(vxm_face_list *list, const vxm_repair_state *state, size_t face,
                       const uint32_t *corner, size_t corners) {
  const vxm_soup *soup = state->soup;
  for (size_t i = 0; i < corners; i++)
    list->indices[list->corners + i] = corner[i];
  if (list->tags)
    list->tags[list->count] = soup->face_tags[face];
  if (list->parts)
    list->parts[list->count] = soup->face_parts[face];
  if (list->turned)
    list->turned[list->count] = state->turned[face];
  list->corners += corners;
  list->offsets[++list->count] = list->corners;
}

void vxm_face_list_exchange(vxm_face_list *list, vxm_repair_state *state) {
  vxm_soup *soup = state->soup;
  vxm_face_list old = {soup->offsets, soup->indices, soup->face_tags, soup->face_parts, state->turned, 0, 0};
  soup->offsets = list->offsets;
  soup->indices = list->indices;
  soup->face_tags = list->tags;
  soup->face_parts = list->parts;
  state->turned = list->turned;
  soup->face_count = soup->face_capacity = list->count;
  soup->corner_count = soup->corner_capacity = list->corners;
  *list = old;
  state->renumbered = true;
  vxm_repair_state_touch(state);
}
