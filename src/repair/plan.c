/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/repair.h"

#include "mesh/census.h"
#include "repair/work.h"

#include <inttypes.h>
#include <math.h>

static const char *const names[VXM_PASS_COUNT] = {
    [VXM_PASS_ROUNDING] = "rounding",
    [VXM_PASS_NONFINITE] = "nonfinite_vertices",
    [VXM_PASS_EXACT_WELD] = "exact_weld",
    [VXM_PASS_TOLERANT_WELD] = "tolerant_weld",
    [VXM_PASS_REPEATED_CORNERS] = "repeated_corners",
    [VXM_PASS_ZERO_AREA] = "zero_area_faces",
    [VXM_PASS_DUPLICATES] = "duplicate_faces",
    [VXM_PASS_OPPOSITE_DUPLICATES] = "opposite_duplicate_faces",
    [VXM_PASS_ORIENTATION] = "orientation",
    [VXM_PASS_WRAP] = "wrap",
    [VXM_PASS_SEPARATION] = "separation",
    [VXM_PASS_CLOSING] = "closing",
    [VXM_PASS_SMALL_PARTS] = "small_parts",
    [VXM_PASS_UNION] = "union",
    [VXM_PASS_APART] = "apart",
    [VXM_PASS_UNUSED] = "unused_vertices",
};

static vxm_status check_options(vxm_repair_options *chosen, const vxm_repair_options *options,
                                vxm_error *error) {
  *chosen = (vxm_repair_options)VXM_REPAIR_OPTIONS_INIT;
  if (!options)
    return VXM_OK;
  *chosen = *options;
  if (options->version != 1)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: options version %" PRIu32 " is unknown; use the initializer", options->version);
  if (options->weld != VXM_WELD_AUTO && options->weld != VXM_WELD_OFF && options->weld != VXM_WELD_TOLERANCE)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: %d is no way of welding", (int)options->weld);
  if (!isfinite(options->weld_tolerance) || options->weld_tolerance < 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: a weld tolerance of %g; it must be 0 or more",
                    options->weld_tolerance);
  if (options->level < VXM_LEVEL_CLEAN || options->level > VXM_LEVEL_SOLID || options->fill < VXM_FILL_FAN ||
      options->fill > VXM_FILL_SMOOTH)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: level %d or fill %d is unknown", (int)options->level,
                    (int)options->fill);
  if (options->keep_orientation && options->level > VXM_LEVEL_CLEAN)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: a level above clean turns faces; leave out keep_orientation");
  if (!(options->wrap_alpha >= 0 && options->wrap_alpha <= 1) ||
      !(options->wrap_offset >= 0 && options->wrap_offset <= 1))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: wrap %g, %g; both are fractions of the diagonal, 0 to 1", options->wrap_alpha,
                    options->wrap_offset);
  if (options->wrap_alpha > 0 && (options->fill_holes != 0 || options->fill != VXM_FILL_FAN ||
                                  options->unite || options->max_change > 0))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: a wrap makes a new surface, without holes or parts to compare; leave out "
                    "fill_holes, fill, unite and max_change");
  if (!(options->max_change >= 0) || !isfinite(options->max_change))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "repair: a change of %g at most; it must be 0 or more",
                    options->max_change);
  if (options->drop_faces < 0 || !(options->drop_volume >= 0))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "repair: parts below %" PRId64 " faces or a volume of %g; both must be 0 or more",
                    options->drop_faces, options->drop_volume);
  return VXM_OK;
}

static vxm_status run_pass(vxm_work *work, vxm_pass_fn pass, double fraction, bool *changed,
                           vxm_error *error) {
  vxm_status status = vxm_progress(work->context, "repairing", fraction, error);
  return status == VXM_OK ? pass(work, changed, error) : status;
}

/**
 * Runs the passes that may make work for each other round and round, until each has found nothing to do since
 * the last change; as each change takes away vertices or corners, this ends. Cracks are looked for last:
 * doubled faces hide them, and faces without area may bridge them.
 */
static vxm_status run_until_quiet(vxm_work *work, vxm_error *error) {
  static const vxm_pass_fn round[] = {vxm_pass_repeated_corners, vxm_pass_zero_area, vxm_pass_duplicates,
                                      vxm_pass_tolerant_weld};
  enum { PASSES = sizeof round / sizeof *round };
  /* a given tolerance applies to the mesh as it is */
  int next = work->options.weld == VXM_WELD_TOLERANCE ? PASSES - 1 : 0, quiet = 0;
  double fraction = 0.3;
  while (quiet < PASSES) {
    bool changed;
    vxm_status status = run_pass(work, round[next], fraction, &changed, error);
    if (status != VXM_OK)
      return status;
    /* welding may leave work to itself: a vertex that is no longer in the way lets others merge */
    bool settled = round[next] != vxm_pass_tolerant_weld;
    quiet = changed ? settled : quiet + 1;
    next = (next + 1) % PASSES;
    fraction += (0.9 - fraction) / 8;
  }
  return VXM_OK;
}

/** The passes that a level or an option asks for; each does nothing where none does. */
static vxm_status run_further(vxm_work *work, vxm_error *error) {
  static const struct {
    vxm_pass_fn pass;
    bool turns; /**< what it changes may be turned otherwise */
  } further[] = {{vxm_pass_unused, false},     {vxm_pass_wrap, false},       {vxm_pass_separation, true},
                 {vxm_pass_closing, true},     {vxm_pass_small_parts, true}, {vxm_pass_union, false},
                 {vxm_pass_separation, false}, {vxm_pass_apart, true},       {vxm_pass_reunion, false},
                 {vxm_pass_separation, false}, {vxm_pass_apart, true},       {vxm_pass_unused, false}};
  enum { FURTHER = sizeof further / sizeof *further };
  vxm_status status = VXM_OK;
  for (int i = 0; i < FURTHER && status == VXM_OK; i++) {
    bool changed;
    status = run_pass(work, further[i].pass, 0.9 + 0.1 * i / FURTHER, &changed, error);
    if (status == VXM_OK && changed && further[i].turns)
      status = run_pass(work, vxm_pass_orientation, 0.9 + 0.1 * i / FURTHER, &changed, error);
  }
  return status;
}

static vxm_status run_passes(vxm_work *work, vxm_error *error) {
  bool changed;
  vxm_status status = run_pass(work, vxm_pass_rounding, 0.0, &changed, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_nonfinite, 0.0, &changed, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_exact_weld, 0.1, &changed, error);
  if (status == VXM_OK)
    status = run_until_quiet(work, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_orientation, 0.85, &changed, error);
  if (status == VXM_OK && work->track)
    vxm_track_settle(work->track, work->soup);
  return status == VXM_OK ? run_further(work, error) : status;
}

static bool keeps_account(const vxm_repair_options *options) {
  return options->part_changes || options->max_change > 0 || options->intersections;
}

static vxm_status repair_copy(vxm_work *work, const vxm_soup *in, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t vertices = work->soup->vertex_count;
  work->gone = vxm_work_scratch(work, vertices, sizeof *work->gone, &status, error);
  if (work->gone)
    work->used = vxm_work_scratch(work, vertices, sizeof *work->used, &status, error);
  if (work->used && keeps_account(&work->options))
    status = vxm_track_create(&work->track, work->soup, in, error);
  if (work->used && status == VXM_OK)
    status = run_passes(work, error);
  if (status == VXM_OK && work->track)
    status = vxm_track_finish(work->track, work->soup, work->options.max_change, error);
  if (status == VXM_OK && work->options.intersections)
    status = vxm_track_count_crossings(work->track, work->soup, work->crossings, error);
  vxm_work_touch(work);
  vxm_track_destroy(work->track);
  vxm_free(work->context, work->used);
  vxm_free(work->context, work->gone);
  return status;
}

static void list_passes(vxm_repair_report *report, const vxm_work *work) {
  report->nonorientable_patches = work->nonorientable;
  report->open_parts = work->open_parts;
  report->unfilled_holes = work->unfilled;
  report->ununited_parts = work->ununited;
  report->self_intersections_before = work->crossings[0];
  report->self_intersections_after = work->crossings[1];
  for (size_t i = 0; i < work->soup->part_count; i++)
    report->moved = fmax(report->moved, work->soup->part_changes[i].moved);
  report->pass_count = VXM_PASS_COUNT;
  for (int pass = 0; pass < VXM_PASS_COUNT; pass++) {
    report->passes[pass].pass = names[pass];
    report->passes[pass].count = work->counts[pass];
  }
}

vxm_status vxm_repair_run(vxm_soup **out, vxm_repair_report *report, const vxm_soup *in,
                          const vxm_repair_options *options, vxm_error *error) {
  *out = NULL;
  vxm_repair_report made = {0};
  vxm_work work = {.context = in->context, .crossings = {-1, -1}};
  vxm_status status = check_options(&work.options, options, error);
  if (status == VXM_OK && report)
    status = vxm_soup_census(&made.before, in, error);
  if (status == VXM_OK)
    status = vxm_soup_copy(&work.soup, in, error);
  if (status == VXM_OK)
    status = repair_copy(&work, in, error);
  if (status == VXM_OK && report)
    status = vxm_soup_census(&made.after, work.soup, error);
  if (status != VXM_OK) {
    vxm_soup_destroy(work.soup);
    work.soup = NULL;
  } else
    list_passes(&made, &work);
  if (report)
    *report = made;
  if (status != VXM_OK && report)
    *report = (vxm_repair_report){0};
  *out = work.soup;
  return status;
}
