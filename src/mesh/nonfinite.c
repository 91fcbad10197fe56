/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/nonfinite.h"

static bool has_nonfinite(const vxm_soup *soup) {
  for (size_t v = 0; v < soup->vertex_count; v++)
    if (!vxm_is_finite(vxm_position(soup, v)))
      return true;
  return false;
}

size_t vxm_nonfinite_faces(size_t *first, const vxm_soup *soup) {
  size_t found = 0;
  if (!has_nonfinite(soup))
    return 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    if (!vxm_face_is_finite(soup, corner, count) && found++ == 0)
      *first = f;
  }
  return found;
}

void vxm_nonfinite_collapse(uint32_t *welded, const vxm_soup *soup) {
  if (!has_nonfinite(soup))
    return;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count, kept = 0;
    const uint32_t *corner = vxm_face(soup, f, &count);
    if (vxm_face_is_finite(soup, corner, count))
      continue;
    while (kept + 1 < count && !vxm_is_finite(vxm_position(soup, corner[kept])))
      kept++;
    uint32_t *to = welded + soup->offsets[f];
    for (size_t c = 0, one = to[kept]; c < count; c++)
      to[c] = (uint32_t)one;
  }
}
