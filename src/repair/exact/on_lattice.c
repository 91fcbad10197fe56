/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/exact/on_lattice.h"

#include "repair/state/merge_rule.h"
#include "repair/state/self_intersections.h"

#include <math.h>
#include <string.h>

/** A copy with what vxm_soup_copy leaves to repairs. */
static vxm_status copy(vxm_soup **out, uint8_t **turned, const vxm_soup *soup, const uint8_t *marks,
                       vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *turned = NULL;
  if (vxm_soup_copy(out, soup, &local) == VXM_OK && soup->face_parts) {
    (*out)->face_parts = vxm_alloc(soup->context, soup->face_count, sizeof *soup->face_parts, &local);
    if ((*out)->face_parts)
      memcpy((*out)->face_parts, soup->face_parts, soup->face_count * sizeof *soup->face_parts);
  }
  if (local.code == VXM_OK && marks)
    *turned = vxm_alloc(soup->context, soup->face_count, 1, &local);
  if (*turned)
    memcpy(*turned, marks, soup->face_count);
  if (local.code != VXM_OK) {
    vxm_soup_destroy(*out);
    *out = NULL;
    vxm_error_pass(error, &local);
  }
  return local.code;
}

vxm_status vxm_before_union_keep(vxm_before_union *out, const vxm_repair_state *state, vxm_error *error) {
  out->state = *state;
  vxm_status status = state->provenance ? vxm_provenance_remember(state->provenance, error) : VXM_OK;
  return status != VXM_OK ? status : copy(&out->soup, &out->turned, state->soup, state->turned, error);
}

void vxm_before_union_destroy(vxm_before_union *kept, vxm_context *context) {
  vxm_free(context, kept->turned);
  vxm_soup_destroy(kept->soup);
  *kept = (vxm_before_union){.soup = NULL};
}

vxm_status vxm_snap_to_lattice(vxm_repair_state *state, bool *changed, vxm_error *error) {
  (void)error;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  double diagonal = vxm_extent_diagonal(extent.bounds);
  double lattice = ldexp(1, ilogb(diagonal > 0 ? diagonal : 1) - state->union_try.bits);
  *changed = isfinite(diagonal) && lattice > 0; /* else at the ends of the numbers */
  if (!*changed)
    return VXM_OK;
  for (size_t i = 0; i < 3 * state->soup->vertex_count; i++)
    state->soup->positions[i] =
        vxm_repair_state_round(state, lattice * rint(state->soup->positions[i] / lattice));
  vxm_repair_state_move(state);
  return VXM_OK;
}

vxm_status vxm_before_union_again(vxm_repair_state *state, const vxm_before_union *kept, vxm_error *error) {
  vxm_soup *soup;
  uint8_t *turned;
  vxm_status status = copy(&soup, &turned, kept->soup, kept->turned, error);
  if (status != VXM_OK)
    return status;
  vxm_repair_state_touch(state);
  vxm_soup_destroy(state->soup);
  vxm_free(state->context, state->turned);
  uint8_t *gone = state->gone, *used = state->used;
  *state = kept->state;
  state->soup = soup;
  state->turned = turned;
  state->gone = gone;
  state->used = used;
  state->has_counts = state->has_edges = state->has_patches = state->has_extent = state->has_sums =
      state->is_manifold = false; /* it was of another soup */
  if (state->provenance)
    vxm_provenance_recall(state->provenance);
  return vxm_repair_state_renew(state, error);
}

vxm_status vxm_union_fell_short(bool *out, const vxm_repair_state *state, vxm_error *error) {
  *out = state->union_failures > 0 ? state->union_may_succeed : state->unparted_vertices > 0;
  if (*out || state->union_failures > 0)
    return VXM_OK;
  vxm_face_pairs pairs;
  vxm_status status = vxm_self_intersections_find(&pairs, state->soup, 1, error);
  vxm_free(state->context, pairs.pairs);
  *out = status == VXM_OK && pairs.count > 0;
  return status;
}
