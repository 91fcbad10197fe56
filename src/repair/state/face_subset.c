/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/face_subset.h"

#include <string.h>

/** Gives the faces taken the tags that they have, which decide between those of a rim. */
static bool take_tags(vxm_soup *taken, const uint64_t *numbers, const vxm_soup *soup, vxm_error *error) {
  if (!soup->face_tags)
    return true;
  taken->face_tags = vxm_alloc(soup->context, taken->face_count, sizeof *taken->face_tags, error);
  for (size_t f = 0; taken->face_tags && f < taken->face_count; f++)
    taken->face_tags[f] = soup->face_tags[numbers[f]];
  return taken->face_tags != NULL;
}

vxm_status vxm_face_subset_create(vxm_soup **out, uint64_t **numbers, const vxm_soup *soup,
                                  const uint8_t *marks, uint8_t mark, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *numbers = vxm_alloc(soup->context, soup->face_count, sizeof **numbers, &local);
  *out = NULL;
  if (*numbers && vxm_soup_create(out, soup->context, soup->format, &local) == VXM_OK &&
      vxm_soup_reserve(*out, soup->vertex_count, soup->face_count, soup->corner_count, &local) == VXM_OK) {
    if (soup->vertex_count > 0)
      memcpy((*out)->positions, soup->positions, 3 * soup->vertex_count * sizeof *soup->positions);
    (*out)->vertex_count = soup->vertex_count;
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t count;
      const uint32_t *corner = vxm_face(soup, f, &count);
      if (marks[f] != mark)
        continue;
      (*numbers)[(*out)->face_count] = f;
      vxm_soup_add_face(*out, corner, count, NULL); /* there is room */
    }
    if (take_tags(*out, *numbers, soup, &local))
      return VXM_OK;
  }
  vxm_free(soup->context, *numbers);
  vxm_soup_destroy(*out);
  *numbers = NULL;
  *out = NULL;
  vxm_error_pass(error, &local);
  return local.code;
}
