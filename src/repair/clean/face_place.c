/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/face_place.h"

typedef struct face_place {
  const double *low, *high; /**< of its corners that which comes first in space, and that which comes last */
  vxm_vec3 sum;             /**< of all of them, from the first */
} face_place;

static face_place place_of(const vxm_soup *soup, size_t face, double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  face_place p = {.low = vxm_position(soup, corner[0]), .high = vxm_position(soup, corner[0])};
  for (size_t i = 1; i < count; i++) {
    const double *at = vxm_position(soup, corner[i]);
    p.low = vxm_lies_before(at, p.low) ? at : p.low;
    p.high = vxm_lies_before(p.high, at) ? at : p.high;
  }
  for (size_t i = 0; i < count; i++)
    p.sum = vxm_vec3_sum(p.sum, vxm_vec3_between(vxm_position(soup, corner[i]), p.low, scale));
  return p;
}

bool vxm_face_lies_before(const vxm_soup *soup, size_t face, size_t other, double scale) {
  face_place p = place_of(soup, face, scale), q = place_of(soup, other, scale);
  if (vxm_lies_before(p.low, q.low) || vxm_lies_before(q.low, p.low))
    return vxm_lies_before(p.low, q.low);
  if (vxm_lies_before(p.high, q.high) || vxm_lies_before(q.high, p.high))
    return vxm_lies_before(p.high, q.high);
  return vxm_lies_before((double[]){p.sum.x, p.sum.y, p.sum.z}, (double[]){q.sum.x, q.sum.y, q.sum.z});
}
