/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/repair.h"

#include "mesh/census.h"
#include "mesh/weld_soup.h"
#include "repair/pipeline.h"
#include "repair/repair_sets.h"

#include <math.h>

static const char *const names[VXM_PASS_COUNT] = {
    [VXM_PASS_ROUNDING] = "rounding",
    [VXM_PASS_NONFINITE] = "nonfinite_vertices",
    [VXM_PASS_EXACT_WELD] = "exact_weld",
    [VXM_PASS_TOLERANT_WELD] = "tolerant_weld",
    [VXM_PASS_REPEATED_CORNERS] = "repeated_corners",
    [VXM_PASS_DEGENERATE_FACES] = "zero_area_faces",
    [VXM_PASS_T_JUNCTIONS] = "t_junctions",
    [VXM_PASS_DUPLICATES] = "duplicate_faces",
    [VXM_PASS_OPPOSITE_DUPLICATES] = "opposite_duplicate_faces",
    [VXM_PASS_INNER_WALLS] = "inner_walls",
    [VXM_PASS_ORIENTATION] = "orientation",
    [VXM_PASS_WRAP] = "wrap",
    [VXM_PASS_CUT_NONMANIFOLD] = "separation",
    [VXM_PASS_CLOSING] = "closing",
    [VXM_PASS_SMALL_COMPONENTS] = "small_parts",
    [VXM_PASS_SHEETS] = "sheets",
    [VXM_PASS_UNION] = "union",
    [VXM_PASS_PERTURB_COINCIDENT] = "apart",
    [VXM_PASS_UNUSED] = "unused_vertices",
};

static bool keeps_account(const vxm_repair_options *options) {
  return options->part_changes || options->max_change > 0 || options->intersections;
}

/** Gives the faces of the copy their parts where nothing else does. */
static vxm_status name_guarded(vxm_repair_state *state, const vxm_soup *in, vxm_error *error) {
  vxm_status status = VXM_OK;
  if (!state->guards_lost_parts || state->provenance)
    return status;
  state->soup->face_parts =
      vxm_repair_state_scratch(state, in->face_count, sizeof *state->soup->face_parts, &status, error);
  for (size_t f = 0; status == VXM_OK && f < in->face_count; f++)
    state->soup->face_parts[f] = state->lost.face_part[f];
  return status;
}

static vxm_status repair_copy(vxm_repair_state *state, const vxm_soup *in, bool *again, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t vertices = state->soup->vertex_count;
  state->gone = vxm_repair_state_scratch(state, vertices, sizeof *state->gone, &status, error);
  if (state->gone)
    state->used = vxm_repair_state_scratch(state, vertices, sizeof *state->used, &status, error);
  if (state->used && keeps_account(&state->options))
    status = vxm_provenance_create(&state->provenance, state->soup, in, error);
  if (state->used && status == VXM_OK)
    status = name_guarded(state, in, error);
  if (state->used && status == VXM_OK)
    status = vxm_pipeline_run(state, in, again, error);
  if (status == VXM_OK && !*again && state->provenance)
    status = vxm_provenance_finish(state->provenance, state->soup, state->options.max_change, error);
  if (status == VXM_OK && !*again && state->options.intersections)
    status = vxm_provenance_count_crossings(state->provenance, state->soup, state->self_intersections, error);
  if (!state->provenance && state->soup->face_parts) { /* they were for the guard alone */
    vxm_free(state->context, state->soup->face_parts);
    state->soup->face_parts = NULL;
  }
  vxm_repair_state_touch(state);
  vxm_provenance_destroy(state->provenance);
  vxm_free(state->context, state->turned);
  vxm_free(state->context, state->used);
  vxm_free(state->context, state->gone);
  return status;
}

static void list_passes(vxm_repair_report *report, const vxm_repair_state *state) {
  report->nonorientable_patches = state->nonorientable_patches;
  report->open_parts = state->open_parts;
  report->sheets = state->sheets;
  report->filled_holes = state->filled_holes;
  report->unfilled_holes = state->unfilled_holes;
  report->fan_fallbacks = state->fan_fallbacks;
  report->union_failures = state->union_failures;
  report->union_tries = state->union_tries;
  report->wrapped_parts = state->wrapped_parts;
  report->self_intersections_before = state->self_intersections[0];
  report->self_intersections_after = state->self_intersections[1];
  report->unparted_vertices = state->unparted_vertices;
  report->lost_parts = state->lost_parts;
  report->emptied_parts = state->emptied_parts;
  report->shared_faces = state->options.level == VXM_LEVEL_CLEAN ? state->shared_faces : 0;
  for (size_t i = 0; i < state->soup->part_count; i++) {
    const vxm_part_change *part = &state->soup->part_changes[i];
    report->max_displacement = fmax(report->max_displacement, part->max_displacement);
    report->opened_parts += part->before->closed && part->after->faces > 0 && !part->after->closed;
  }
  report->pass_count = VXM_PASS_COUNT;
  for (int pass = 0; pass < VXM_PASS_COUNT; pass++) {
    report->passes[pass].pass = names[pass];
    report->passes[pass].count = state->counts[pass];
  }
}

/** Repairs a copy; after a failure there is none. Where that would lose a part it is done once more, with
 * that one guarded. */
static vxm_status repair(vxm_repair_state *state, const vxm_soup *in, const vxm_repair_options *options,
                         vxm_error *error) {
  const bool divides = state->divides;
  bool again = false;
  vxm_lost_parts lost = {0};
  vxm_status status;
  do {
    *state = (vxm_repair_state){.context = in->context,
                                .divides = divides,
                                .guards_lost_parts = again,
                                .lost = lost,
                                .self_intersections = {-1, -1}};
    again = false;
    status = vxm_repair_check(&state->options, options, error);
    if (status == VXM_OK)
      status = vxm_soup_copy(&state->soup, in, error);
    if (status == VXM_OK)
      status = repair_copy(state, in, &again, error);
    lost = state->lost;
    if (status != VXM_OK || again)
      vxm_soup_destroy(state->soup);
  } while (status == VXM_OK && again);
  vxm_lost_parts_destroy(&lost, in->context);
  state->lost = lost;
  if (status != VXM_OK)
    state->soup = NULL;
  return status;
}

/** `*shared` becomes the number of faces that repeat others and stayed, at the level clean. */
static vxm_status run(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                      const vxm_repair_options *options, bool divides, int64_t *shared, vxm_error *error) {
  *out = NULL;
  vxm_repair_report made = {.before = report ? report->before : NULL, .after = report ? report->after : NULL};
  vxm_repair_state state = {.divides = divides};
  vxm_status status = made.before ? vxm_soup_census(made.before, in, error) : VXM_OK;
  if (status == VXM_OK)
    status = repair(&state, in, options, error);
  if (status == VXM_OK && made.after)
    status = vxm_soup_census(made.after, state.soup, error);
  if (status == VXM_OK)
    list_passes(&made, &state);
  else
    vxm_soup_destroy(state.soup);
  if (report)
    *report = status == VXM_OK ? made : (vxm_repair_report){.before = made.before, .after = made.after};
  *out = status == VXM_OK ? state.soup : NULL;
  *shared = made.shared_faces;
  return status;
}

vxm_status vxm_repair_run(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                          const vxm_repair_options *options, vxm_error *error) {
  int64_t shared;
  return run(out, report, in, options, false, &shared, error);
}

vxm_status vxm_repair_prepare(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                              const vxm_repair_options *options, vxm_error *error) {
  if (in->face_sets)
    return vxm_repair_prepare_sets(out, report, in, options, error);
  int64_t shared;
  vxm_repair_options apart = VXM_REPAIR_OPTIONS_INIT;
  if (options)
    apart = *options;
  vxm_status status = run(out, report, in, options, !apart.keep_orientation, &shared, error);
  if (status != VXM_OK || shared == 0 || apart.keep_orientation)
    return status;
  vxm_soup_destroy(*out);
  apart.level = VXM_LEVEL_MANIFOLD;
  return run(out, report, in, &apart, true, &shared, error);
}

/** Whether to weld before anything else: a soup with a vertex for every corner, where that changes no report,
 * as nobody asks for a vertex or a part of it as it is. */
static bool is_welded_first(const vxm_soup *in, const vxm_repair_report *report,
                            const vxm_repair_options *options) {
  return in->vertex_count == in->corner_count && !in->face_sets && !(report && report->before) &&
         !(options && keeps_account(options));
}

vxm_status vxm_repair_prepare_owned(vxm_soup **out, vxm_repair_report *report, vxm_soup *in,
                                    const vxm_repair_options *options, vxm_error *error) {
  *out = NULL;
  size_t merged = 0;
  vxm_status status = is_welded_first(in, report, options) ? vxm_weld_soup(in, &merged, error) : VXM_OK;
  if (status == VXM_OK)
    status = vxm_repair_prepare(out, report, in, options, error);
  if (status == VXM_OK && report)
    report->passes[VXM_PASS_EXACT_WELD].count += (int64_t)merged;
  vxm_soup_destroy(in);
  return status;
}

vxm_status vxm_repair_try(vxm_pass_finding findings[VXM_PASS_COUNT], const vxm_soup *in,
                          const vxm_repair_options *options, vxm_error *error) {
  vxm_repair_state state = {0};
  vxm_status status = repair(&state, in, options, error);
  for (int pass = 0; pass < VXM_PASS_COUNT && status == VXM_OK; pass++) {
    findings[pass] = state.firsts[pass];
    findings[pass].pass = names[pass];
    findings[pass].count = state.counts[pass];
  }
  vxm_soup_destroy(state.soup);
  return status;
}
