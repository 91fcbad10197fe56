/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/split.h"

#include "mesh/sort.h"
#include "mesh/triangulate.h"
#include "repair/state/face_list.h"

/** Whether a corner of a polygon comes twice. */
static bool touches_itself(const uint32_t *corner, size_t count, uint64_t *sorted) {
  for (size_t i = 0; i < count; i++)
    sorted[i] = corner[i];
  vxm_sort_keys(sorted, sorted + count, count);
  for (size_t i = 1; i < count; i++)
    if (sorted[i] == sorted[i - 1])
      return true;
  return false;
}

static vxm_status split(vxm_face_list *to, const vxm_repair_state *state, const uint8_t *wanted,
                        vxm_error *error) {
  const vxm_soup *soup = state->soup;
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, soup->context);
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count), *triangles;
    if (!wanted[f]) {
      vxm_face_list_put(to, state, f, corner, count);
      continue;
    }
    status = vxm_triangulate(&tri, soup->positions, corner, count, &triangles, error);
    for (size_t t = 0; t + 2 < count && status == VXM_OK; t++)
      if (vxm_face_has_three(triangles + 3 * t, 3, NULL))
        vxm_face_list_put(to, state, f, triangles + 3 * t, 3);
  }
  vxm_triangulator_close(&tri);
  return status;
}

static vxm_status split_marked(vxm_repair_state *state, const uint8_t *wanted, vxm_error *error) {
  vxm_soup *soup = state->soup;
  size_t count = soup->face_count, corners = soup->corner_count;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n = (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
    count += wanted[f] ? n - 3 : 0;
    corners += wanted[f] ? 3 * (n - 2) - n : 0;
  }
  if (corners == soup->corner_count)
    return VXM_OK;
  vxm_face_list made;
  vxm_status status = vxm_face_list_create(&made, state, count, corners, error);
  if (status == VXM_OK)
    status = split(&made, state, wanted, error);
  if (status == VXM_OK)
    vxm_face_list_exchange(&made, state);
  vxm_face_list_destroy(&made, state);
  return status;
}

vxm_status vxm_split_polygons(vxm_repair_state *state, bool touching, vxm_error *error) {
  const vxm_soup *soup = state->soup;
  vxm_status status = VXM_OK;
  size_t largest = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    if (soup->offsets[f + 1] - soup->offsets[f] > largest)
      largest = (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
  if (largest <= 3)
    return VXM_OK;
  uint8_t *wanted = vxm_repair_state_scratch(state, soup->face_count, sizeof *wanted, &status, error);
  uint64_t *sorted =
      wanted ? vxm_repair_state_scratch(state, 2 * largest, sizeof *sorted, &status, error) : NULL;
  for (size_t f = 0; sorted && f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    wanted[f] = count > 3 && (!touching || touches_itself(corner, count, sorted));
  }
  if (sorted)
    status = split_marked(state, wanted, error);
  vxm_free(state->context, sorted);
  vxm_free(state->context, wanted);
  return status;
}
