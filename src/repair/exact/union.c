/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/bits.h"
#include "mesh/components.h"
#include "repair/exact/union_loss.h"
#include "repair/state/repair_state.h"
#include "repair/state/self_intersections.h"

/** Why a component is left. */
enum { FAILED = 1, CROSSING = 2 };

/** What the union leaves as it was although it cuts through something. */
typedef struct leaving {
  vxm_repair_state *state;
  const uint64_t *origin; /**< per face of the united soup */
  uint32_t *component;    /**< the same */
  uint8_t *left;          /**< per component: FAILED, CROSSING */
  size_t count;
} leaving;

/** Marks the components of faces where the module failed. */
static vxm_status mark_failed(leaving *l, const vxm_soup *soup, const vxm_union_report *report,
                              vxm_error *error) {
  vxm_status status = VXM_OK;
  uint8_t *failed = vxm_repair_state_scratch(l->state, l->state->soup->face_count, 1, &status, error);
  for (int64_t i = 0; failed && i < report->failed; i++)
    failed[report->failed_faces[i]] = 1;
  for (size_t f = 0; failed && f < soup->face_count; f++)
    if (l->origin[f] != VXM_NO_FACE && failed[l->origin[f]])
      l->left[l->component[f]] |= FAILED;
  vxm_free(l->state->context, failed);
  return status;
}

/** Marks those that cut through something still, such as open ones. */
static vxm_status mark_crossing(leaving *l, const vxm_soup *soup, vxm_error *error) {
  vxm_face_pairs pairs;
  vxm_status status = vxm_self_intersections_find(&pairs, soup, VXM_CROSSINGS_MOST, error);
  for (size_t i = 0; i < pairs.count; i++) {
    l->left[l->component[pairs.pairs[i].first]] |= CROSSING;
    l->left[l->component[pairs.pairs[i].second]] |= CROSSING;
  }
  vxm_free(soup->context, pairs.pairs);
  return status;
}

static void tell(leaving *l, const vxm_soup *soup) {
  vxm_repair_state *state = l->state;
  const uint32_t *parts = state->provenance ? state->soup->face_parts : NULL;
  if (!parts)
    state->union_failures = 0; /* of an earlier round; parts that are followed count once */
  for (size_t c = 0; !parts && c < l->count; c++)
    state->union_failures += l->left[c] != 0;
  state->union_may_succeed = false;
  for (size_t c = 0; c < l->count; c++)
    state->union_may_succeed = state->union_may_succeed || l->left[c] == (FAILED | CROSSING);
  for (size_t f = 0; parts && f < soup->face_count; f++)
    if (l->left[l->component[f]] && l->origin[f] != VXM_NO_FACE)
      state->union_failures += vxm_provenance_leave(state->provenance, parts[l->origin[f]]);
}

/** Counts and names the parts that were left: those of the mesh as it was read, if they are followed. What is
 * open or bounds no volume is among them if it cuts through something. */
static vxm_status find_left(vxm_repair_state *state, const vxm_soup *soup, const uint64_t *origin,
                            const vxm_union_report *report, vxm_error *error) {
  leaving l = {.state = state, .origin = origin};
  vxm_status status = VXM_OK;
  l.component = vxm_repair_state_scratch(state, soup->face_count, sizeof *l.component, &status, error);
  if (status == VXM_OK)
    status = vxm_components(state->context, soup, NULL, l.component, &l.count, error);
  if (status == VXM_OK)
    l.left = vxm_repair_state_scratch(state, l.count, sizeof *l.left, &status, error);
  if (status == VXM_OK)
    status = mark_failed(&l, soup, report, error);
  if (status == VXM_OK)
    status = mark_crossing(&l, soup, error);
  if (status == VXM_OK)
    tell(&l, soup);
  vxm_free(state->context, l.left);
  vxm_free(state->context, l.component);
  return status;
}

/** Parts that lie inside of others go: they were to. */
static vxm_status note_swallowed(vxm_repair_state *state, const vxm_soup *soup, const uint64_t *origin,
                                 vxm_error *error) {
  const uint32_t *parts = state->soup->face_parts;
  if (!state->provenance || !parts)
    return VXM_OK;
  vxm_status status = VXM_OK;
  size_t count = vxm_provenance_part_count(state->provenance);
  uint8_t *here = vxm_repair_state_scratch(state, count, sizeof *here, &status, error);
  for (size_t f = 0; here && f < state->soup->face_count; f++)
    here[parts[f]] |= 1;
  for (size_t f = 0; here && f < soup->face_count; f++)
    if (origin[f] != VXM_NO_FACE)
      here[parts[origin[f]]] |= 2;
  for (size_t p = 0; here && p < count; p++)
    if (here[p] == 1)
      vxm_provenance_drop(state->provenance, (uint32_t)p);
  vxm_free(state->context, here);
  return status;
}

static bool is_asked_for(const vxm_repair_state *state) {
  return (state->options.boolean_union || vxm_repair_state_reaches(state, VXM_LEVEL_SOLID)) &&
         !(state->options.wrap_alpha > 0);
}

/** Unites the closed parts that cut through each other. Open ones have no inside: they stay as they are. */
vxm_status vxm_pass_union(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!is_asked_for(state))
    return VXM_OK;
  const vxm_cgal *cgal;
  vxm_soup *soup;
  uint64_t *origin;
  vxm_union_report report;
  vxm_status status = vxm_cgal_open(&cgal, "uniting parts", error);
  vxm_union_options options = {.outward_only = state->union_try.outward_only,
                               .single_precision = state->options.single_precision};
  if (status == VXM_OK)
    status = cgal->unite(&soup, &origin, &report, state->soup, &options, error);
  if (status != VXM_OK)
    return status;
  status = find_left(state, soup, origin, &report, error);
  vxm_free(state->context, report.failed_faces);
  if (status == VXM_OK)
    status = note_swallowed(state, soup, origin, error);
  *changed = report.united > 0 || report.cut > 0;
  int64_t emptied = 0;
  if (status == VXM_OK && *changed)
    status = vxm_union_loss_find(&emptied, state->soup, soup, error);
  state->emptied_parts = vxm_max(state->emptied_parts, emptied);
  if (status == VXM_OK && *changed) {
    state->counts[VXM_PASS_UNION] += report.united + report.cut;
    return vxm_repair_state_adopt(state, soup, origin, error);
  }
  vxm_soup_destroy(soup);
  vxm_free(state->context, origin);
  return status;
}

/** Again where vertices were moved apart after that: into what lies nearer still, as beside slivers. */
vxm_status vxm_pass_reunion(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  if (!is_asked_for(state) || state->counts[VXM_PASS_PERTURB_COINCIDENT] == 0 || state->union_failures > 0)
    return VXM_OK;
  vxm_face_pairs pairs;
  vxm_status status = vxm_self_intersections_find(&pairs, state->soup, 1, error);
  vxm_free(state->context, pairs.pairs);
  return status == VXM_OK && pairs.count > 0 ? vxm_pass_union(state, changed, error) : status;
}
