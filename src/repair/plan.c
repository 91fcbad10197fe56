/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/repair.h"

#include "mesh/census.h"
#include "repair/work.h"

#include <inttypes.h>
#include <math.h>

static const char *const names[VXM_PASS_COUNT] = {
    [VXM_PASS_NONFINITE] = "nonfinite_vertices",
    [VXM_PASS_EXACT_WELD] = "exact_weld",
    [VXM_PASS_TOLERANT_WELD] = "tolerant_weld",
    [VXM_PASS_REPEATED_CORNERS] = "repeated_corners",
    [VXM_PASS_ZERO_AREA] = "zero_area_faces",
    [VXM_PASS_DUPLICATES] = "duplicate_faces",
    [VXM_PASS_OPPOSITE_DUPLICATES] = "opposite_duplicate_faces",
    [VXM_PASS_ORIENTATION] = "orientation",
    [VXM_PASS_CLOSING] = "closing",
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

static vxm_status run_passes(vxm_work *work, vxm_error *error) {
  bool changed;
  vxm_status status = run_pass(work, vxm_pass_nonfinite, 0.0, &changed, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_exact_weld, 0.1, &changed, error);
  if (status == VXM_OK)
    status = run_until_quiet(work, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_orientation, 0.9, &changed, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_closing, 0.93, &changed, error);
  /* a part that was open may be turned otherwise now that it is closed */
  if (status == VXM_OK && changed)
    status = run_pass(work, vxm_pass_orientation, 0.96, &changed, error);
  if (status == VXM_OK)
    status = run_pass(work, vxm_pass_unused, 0.98, &changed, error);
  return status;
}

static vxm_status repair_copy(vxm_work *work, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t vertices = work->soup->vertex_count;
  work->gone = vxm_work_scratch(work, vertices, sizeof *work->gone, &status, error);
  if (work->gone)
    work->used = vxm_work_scratch(work, vertices, sizeof *work->used, &status, error);
  if (work->used)
    status = run_passes(work, error);
  vxm_work_touch(work);
  vxm_free(work->context, work->used);
  vxm_free(work->context, work->gone);
  return status;
}

static void list_passes(vxm_repair_report *report, const vxm_work *work) {
  report->nonorientable_patches = work->nonorientable;
  report->open_parts = work->open_parts;
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
  vxm_work work = {.context = in->context};
  vxm_status status = check_options(&work.options, options, error);
  if (status == VXM_OK && report)
    status = vxm_soup_census(&made.before, in, error);
  if (status == VXM_OK)
    status = vxm_soup_copy(&work.soup, in, error);
  if (status == VXM_OK)
    status = repair_copy(&work, error);
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
