/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/weld/net_merge.h"

#include "repair/manifold/cut_nonmanifold.h"
#include "repair/state/split.h"
#include "repair/state/vertex_fans.h"

/** One in so many merged vertices has to stay merged, or faces only change their partners, again and again.
 */
enum { USEFUL = 8 };

static size_t count_merged(const vxm_repair_state *state, const uint32_t *map) {
  size_t count = 0;
  for (size_t v = 0; v < state->soup->vertex_count; v++)
    count += map[v] != v && !state->gone[v];
  return count;
}

/** A copy of the soup with the vertices merged. */
static vxm_status make_trial(vxm_repair_state *trial, const vxm_repair_state *state, const uint32_t *map,
                             vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t vertices = state->soup->vertex_count;
  *trial = (vxm_repair_state){.context = state->context, .options = state->options};
  status = vxm_soup_copy(&trial->soup, state->soup, error);
  if (status != VXM_OK)
    return status;
  for (size_t c = 0; c < trial->soup->corner_count; c++)
    trial->soup->indices[c] = map[trial->soup->indices[c]];
  trial->gone = vxm_repair_state_scratch(trial, vertices, sizeof *trial->gone, &status, error);
  if (trial->gone)
    trial->used = vxm_repair_state_scratch(trial, vertices, sizeof *trial->used, &status, error);
  return status;
}

static vxm_status count_used(size_t *count, const vxm_soup *soup, vxm_error *error) {
  vxm_extent extent;
  vxm_status status = vxm_extent_find(&extent, soup->context, soup, error);
  *count = status == VXM_OK ? soup->vertex_count - extent.unused : 0;
  return status;
}

/** Separates the trial and counts what is left. */
static vxm_status count_after(size_t *after, const vxm_soup *trial, vxm_error *error) {
  vxm_soup *apart;
  int64_t split, stitched;
  vxm_status status = vxm_cut_nonmanifold(&apart, &split, &stitched, trial, error);
  *after = SIZE_MAX;
  if (status == VXM_OK)
    status = count_used(after, apart, error);
  vxm_soup_destroy(apart);
  return status;
}

/** @param merged vertices that lose their numbers */
static vxm_status compare(bool *helps, vxm_repair_state *trial, const vxm_repair_state *state, size_t merged,
                          vxm_error *error) {
  bool reduced = false, fewer = false;
  size_t before, after = 0;
  vxm_status status = vxm_pass_repeated_corners(trial, &reduced, error);
  if (status == VXM_OK)
    status = vxm_pass_duplicates(trial, &fewer, error);
  *helps = reduced || fewer;
  if (status != VXM_OK || *helps)
    return status;
  status = count_used(&before, state->soup, error);
  if (status == VXM_OK)
    status = vxm_split_polygons(trial, true, error);
  if (status == VXM_OK)
    status = count_after(&after, trial->soup, error);
  *helps = status == VXM_OK && after < before && before - after >= merged / USEFUL;
  return status;
}

vxm_status vxm_merge_helps(bool *helps, vxm_repair_state *state, const uint32_t *map, vxm_error *error) {
  bool manifold = false;
  *helps = true;
  vxm_status status =
      vxm_repair_state_reaches(state, VXM_LEVEL_MANIFOLD) ? vxm_is_manifold(&manifold, state, error) : VXM_OK;
  if (status != VXM_OK || !manifold)
    return status;
  vxm_repair_state trial;
  status = make_trial(&trial, state, map, error);
  if (status == VXM_OK)
    status = compare(helps, &trial, state, count_merged(state, map), error);
  vxm_repair_state_touch(&trial);
  vxm_free(trial.context, trial.used);
  vxm_free(trial.context, trial.gone);
  vxm_soup_destroy(trial.soup);
  return status;
}
