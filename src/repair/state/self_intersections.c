/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/self_intersections.h"

#include "mesh/unit_scale.h"

#include <math.h>

static bool all_finite(const vxm_soup *soup) {
  for (size_t v = 0; v < soup->vertex_count; v++)
    if (!vxm_is_finite(vxm_position(soup, v)))
      return false;
  return true;
}

/** Makes points of the faces that have a vertex which is not finite: those meet nothing. */
static void blunt(vxm_soup *copy) {
  for (size_t f = 0; f < copy->face_count; f++) {
    size_t count, bad = 0;
    const uint32_t *corner = vxm_face(copy, f, &count);
    for (size_t i = 0; i < count; i++)
      bad += !vxm_is_finite(vxm_position(copy, corner[i]));
    for (size_t i = 0; bad > 0 && i < count; i++)
      copy->indices[copy->offsets[f] + i] = corner[0];
  }
  for (size_t i = 0; i < 3 * copy->vertex_count; i++)
    if (!isfinite(copy->positions[i]))
      copy->positions[i] = 0;
}

vxm_status vxm_self_intersections_find(vxm_face_pairs *out, const vxm_soup *soup, size_t most,
                                       vxm_error *error) {
  const vxm_cgal *cgal;
  vxm_soup *copy = NULL;
  *out = (vxm_face_pairs){.complete = true};
  vxm_status status = vxm_cgal_open(&cgal, "looking for self-intersections", error);
  if (status == VXM_OK && !all_finite(soup)) {
    status = vxm_soup_copy(&copy, soup, error);
    if (status == VXM_OK)
      blunt(copy);
  }
  if (status == VXM_OK)
    status = cgal->self_intersections(out, copy ? copy : soup, most, error);
  vxm_soup_destroy(copy);
  return status;
}

vxm_status vxm_self_intersections_count(int64_t *total, vxm_part_state *states, size_t part_count,
                                        const uint32_t *face_parts, const vxm_soup *soup, vxm_error *error) {
  vxm_face_pairs found;
  vxm_status status = vxm_self_intersections_find(&found, soup, VXM_CROSSINGS_MOST, error);
  *total = (int64_t)found.count;
  for (size_t p = 0; states && status == VXM_OK && p < part_count; p++)
    states[p].self_intersections = 0;
  for (size_t i = 0; states && i < found.count; i++) {
    uint32_t one = face_parts[found.pairs[i].first], other = face_parts[found.pairs[i].second];
    states[one].self_intersections++;
    if (other != one)
      states[other].self_intersections++;
  }
  vxm_free(soup->context, found.pairs);
  return status;
}
