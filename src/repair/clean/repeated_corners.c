/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/repair_state.h"

/**
 * Removes, in place, corners that repeat the one before (a a becomes a) and spikes (a b a becomes a), around
 * the face, until there are none. Sides go in pairs or are no edges, so the sides along each edge stay odd or
 * even. What remains has no corners or at least three distinct ones, and starts at *begin.
 */
static size_t reduce(uint32_t *corners, size_t count, size_t *begin) {
  size_t top = 0;
  for (size_t i = 0; i < count; i++) {
    uint32_t v = corners[i];
    if (top > 0 && corners[top - 1] == v)
      continue;
    if (top > 1 && corners[top - 2] == v)
      top--;
    else
      corners[top++] = v;
  }
  /* now the same across the end: inside there is nothing left to remove */
  size_t first = 0;
  for (;;) {
    size_t left = top - first;
    if (left < 3)
      return 0;
    if (corners[top - 1] == corners[first] || corners[top - 2] == corners[first])
      top--;
    else if (corners[top - 1] == corners[first + 1])
      first++;
    else {
      *begin = first;
      return left;
    }
  }
}

static bool needs_reducing(const uint32_t *corners, size_t count) {
  if (count < 3)
    return true;
  if (count == 3)
    return (corners[0] == corners[1]) | (corners[1] == corners[2]) | (corners[2] == corners[0]);
  uint32_t before = corners[count - 2], last = corners[count - 1];
  for (size_t i = 0; i < count; i++) {
    if (corners[i] == last || corners[i] == before)
      return true;
    before = last;
    last = corners[i];
  }
  return false;
}

/** Polygons that touch themselves in a corner, or run along an edge there and later back, are kept. */
vxm_status vxm_pass_repeated_corners(vxm_repair_state *state, bool *changed, vxm_error *error) {
  (void)error;
  vxm_soup *soup = state->soup;
  int64_t count = 0;
  size_t kept = 0, end = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t corners = (size_t)(soup->offsets[f + 1] - soup->offsets[f]), begin = 0;
    uint32_t *face = soup->indices + soup->offsets[f];
    if (needs_reducing(face, corners)) {
      if (count++ == 0)
        vxm_repair_state_note_face(state, VXM_PASS_REPEATED_CORNERS, f);
      corners = reduce(face, corners, &begin);
      if (corners == 0)
        continue;
    }
    if (count > 0) {
      for (size_t i = 0; i < corners; i++)
        soup->indices[end + i] = face[begin + i];
      soup->offsets[kept] = end;
      vxm_repair_state_renumber(state, f, kept);
    }
    kept++;
    end += corners;
  }
  soup->offsets[kept] = end;
  state->renumbered |= kept < soup->face_count;
  soup->face_count = kept;
  soup->corner_count = end;
  state->counts[VXM_PASS_REPEATED_CORNERS] += count;
  *changed = count > 0;
  if (count > 0)
    vxm_repair_state_touch(state);
  return VXM_OK;
}
