/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model_report.h"
#include "voxel/solid/outside_parts.h"
#include "voxel/solid/overhang.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/** A part that has triangles, of which none set a voxel. */
static bool is_empty(const vxm_voxel_pass *pass, size_t part) {
  const vxm_part *p = &pass->analysis->triangles.parts[part];
  return p->begin < p->end && !atomic_load_explicit(&pass->has_voxels[part], memory_order_relaxed);
}

/** The open parts count as empty if together they added nothing, whatever single voters held. */
static void count_empty_parts(vxm_model_pass *pass, vxm_voxelize_report *report) {
  vxm_voxel_pass *solid = &pass->solid;
  const vxm_triangle_set *triangles = &solid->analysis->triangles;
  if (!vxm_one_voter(&solid->options) && !solid->added)
    for (size_t p = vxm_voted_begin(solid->analysis, &solid->options); p < triangles->split.part_count; p++)
      atomic_store_explicit(&solid->has_voxels[p], 0, memory_order_relaxed);
  bool placed = vxm_solid_wanted(&pass->solid.options) && (solid->placed.narrow || solid->placed.wide);
  for (size_t p = 0; p < triangles->split.part_count && placed; p++)
    if (is_empty(solid, p)) {
      bool outside = vxm_part_is_outside(solid, p);
      report->outside_parts += outside;
      report->empty_parts += !outside && !pass->separating;
    }
}

/** A part that lies in the grid, and sets no voxel. */
static bool is_lost(const vxm_voxel_pass *solid, size_t part) {
  return is_empty(solid, part) && !vxm_part_is_outside(solid, part);
}

/** The area of all faces, or of those of parts without a voxel, in squares of voxels. */
static double surface_area(const vxm_voxel_pass *solid, bool lost) {
  const vxm_triangle_set *triangles = &solid->analysis->triangles;
  double unit = (double)solid->placed.lattice.unit, twice = 0;
  for (size_t t = 0; t < triangles->triangle_count; t++) {
    if (vxm_role_of(triangles, t) != VXM_ROLE_FACE || (lost && !is_lost(solid, triangles->part[t])))
      continue;
    const uint32_t *k = triangles->corners[t];
    const vxm_point corner[3] = {vxm_snapped_points_at(&solid->placed, k[0]),
                                 vxm_snapped_points_at(&solid->placed, k[1]),
                                 vxm_snapped_points_at(&solid->placed, k[2])};
    vxm_link_surface surface = vxm_link_surface_of(corner);
    twice += vxm_link_surface_length(&surface);
  }
  return twice / (2 * unit * unit);
}

/** The first few parts that set no voxel, inside or outside of the grid, each by one of its vertices. */
static const char *name_parts(const vxm_model_pass *pass, bool outside, int64_t count, char names[200]) {
  enum { NAMED = 3 };
  size_t used = 0;
  int named = 0;
  const vxm_triangle_set *triangles = &pass->solid.analysis->triangles;
  names[0] = '\0';
  for (size_t p = 0; p < triangles->split.part_count && named < NAMED; p++) {
    if (!is_empty(&pass->solid, p) || vxm_part_is_outside(&pass->solid, p) != outside)
      continue;
    const double *at = triangles->positions[triangles->corners[triangles->parts[p].begin][0]];
    used += (size_t)snprintf(names + used, 200 - used, "%s(%.4g, %.4g, %.4g)", named ? ", " : "", at[0],
                             at[1], at[2]);
    named++;
  }
  if (count > named)
    snprintf(names + used, 200 - used, ", ...");
  return names;
}

/** What helps where there are no voxels. */
static const char *remedy(const vxm_model_pass *pass) {
  return pass->is_field ? "a higher resolution (-r) may keep them"
                        : "--thin keep keeps them, and so may a higher resolution (-r)";
}

static void warn_of_empty_parts(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  char names[200];
  if (report->empty_parts > 0 && report->voxels > 0 && !vxm_faces_wanted(&pass->solid.options))
    vxm_warn(pass->warnings,
             "%" PRId64 " of %" PRId64 " parts, %.3g %% of the surface, hold no voxel centre, being thinner "
             "than a voxel or open sheets: those at %s; %s",
             report->empty_parts, report->parts,
             100 * surface_area(&pass->solid, true) / surface_area(&pass->solid, false),
             name_parts(pass, false, report->empty_parts, names), remedy(pass));
  if (report->outside_parts > 0 && report->voxels > 0)
    vxm_warn(pass->warnings,
             "%" PRId64 " of %" PRId64 " parts lie outside of the grid: those at %s; see --bounds and --like",
             report->outside_parts, report->parts, name_parts(pass, true, report->outside_parts, names));
}

/** "upper x and lower z sides" */
static const char *name_sides(const vxm_overhang *overhang, char names[80]) {
  int count = 0, named = 0;
  size_t used = 0;
  for (int a = 0; a < 3; a++)
    count += overhang->below[a] + overhang->above[a];
  for (int s = 0; s < 6; s++) {
    int a = s / 2;
    if (!(s % 2 ? overhang->above[a] : overhang->below[a]))
      continue;
    const char *between = named == 0 ? "" : named + 1 == count ? " and " : ", ";
    used += (size_t)snprintf(names + used, 80 - used, "%s%s %c", between, s % 2 ? "upper" : "lower", 'x' + a);
    named++;
  }
  snprintf(names + used, 80 - used, count == 1 ? " side" : " sides");
  return names;
}

/** Not of variants that are drawn for training, which go beyond their grid as they were told to. */
static void warn_of_overhang(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  char names[80];
  if (report->voxels == 0 || pass->vertices || pass->solid.motion)
    return;
  vxm_overhang overhang = vxm_overhang_of(&pass->solid.analysis->triangles, &pass->space, pass->transform);
  if (overhang.share > 0)
    vxm_warn(
        pass->warnings,
        "%.3g %% of the surface lies outside of the grid, beyond its %s, and is cut off: wider --bounds, "
        "a larger grid for --like, or neither of them take in all",
        100 * overhang.share, name_sides(&overhang, names));
}

/** Of signed distances, in which nothing is added. */
static void warn_of_thin(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  const double noticed = 0.005;
  if (pass->is_field && report->thin_share >= noticed)
    vxm_warn(
        pass->warnings,
        "%.3g %% of the surface is thinner than a voxel, so that no distance there is negative: a higher "
        "resolution (-r) or --distance unsigned show it, and so does 'voxmend remesh' as a mesh",
        100 * report->thin_share);
}

/** What it means for the grid, and what helps. */
static void warn_of_open(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  bool winding = report->winding_decided > 0;
  const int64_t *dims = pass->space.dims;
  double voxels = (double)dims[0] * (double)dims[1] * (double)dims[2];
  vxm_warn(pass->warnings,
           "the model is open (%zu odd edges): %" PRId64 " voxels, %.3g %% of the grid, are inside or not by "
           "%s; %s",
           pass->solid.analysis->triangles.split.odd_edge_count, report->contested,
           100 * (double)report->contested / voxels, winding ? "the winding number" : "a vote",
           winding
               ? "that is right where openings are small: look at it with 'view'; 'voxmend repair --level "
                 "closed' closes it before, --confidence tells how sure each voxel is"
               : "that may leave holes and streaks: --vote auto asks the winding number");
}

/** Of what parity leaves hollow though it may be solid. */
static void warn_of_hollow_overlaps(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  if (report->hollow_overlaps == 0)
    return;
  const vxm_triangle_set *triangles = &pass->solid.analysis->triangles;
  const vxm_self_overlap *overlap = &pass->solid.analysis->self_overlap;
  const double *at =
      triangles->positions[triangles->corners[triangles->parts[overlap->hollow_part].begin][0]];
  bool one = report->hollow_overlaps == 1;
  vxm_warn(
      pass->warnings,
      "%" PRId64 " of %" PRId64 " parts seem%s to run through %s, but %s faces are wound against each other, "
      "so that %s hollow there: %s%.3g %% of what that at (%.4g, %.4g, %.4g) encloses, which may be a room; "
      "look at it with 'view': --method winding fills it",
      report->hollow_overlaps, report->parts, one ? "s" : "", one ? "itself" : "themselves",
      one ? "its" : "their", one ? "it stays" : "they stay", one ? "" : "up to ", 100 * overlap->hollow_share,
      at[0], at[1], at[2]);
}

/** Of what parity fills though it lies in two cavities. */
static void warn_of_filled_overlaps(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  if (report->filled_overlaps == 0)
    return;
  const vxm_triangle_set *triangles = &pass->solid.analysis->triangles;
  const vxm_self_overlap *overlap = &pass->solid.analysis->self_overlap;
  const double *at =
      triangles->positions[triangles->corners[triangles->parts[overlap->filled_part].begin][0]];
  bool one = report->filled_overlaps == 1;
  vxm_warn(pass->warnings,
           "%" PRId64 " of %" PRId64 " parts ha%s cavities that overlap each other, and what these share is "
           "filled: some %s%.2g %% of that at (%.4g, %.4g, %.4g); --method winding leaves it empty, "
           "'voxmend repair --level solid' unites the cavities",
           report->filled_overlaps, report->parts, one ? "s" : "ve", one ? "" : "up to ",
           100 * overlap->filled_share, at[0], at[1], at[2]);
}

static void warn(vxm_model_pass *pass, const vxm_voxelize_report *report) {
  vxm_warnings *warnings = pass->warnings;
  bool faces = vxm_faces_wanted(&pass->solid.options);
  if (report->voxels == 0 && faces)
    vxm_warn(warnings, "no face meets the grid: check --bounds or --like");
  else if (report->voxels == 0 && report->outside_parts > 0 && report->empty_parts == 0)
    vxm_warn(warnings, "the model lies outside of the grid: check --bounds or --like");
  else if (report->voxels == 0)
    vxm_warn(warnings,
             "no voxel centre is inside: the model is open, flat or thinner than a voxel; try %sa higher "
             "resolution (-r)",
             pass->is_field ? "" : "--thin keep or ");
  warn_of_empty_parts(pass, report);
  warn_of_thin(pass, report);
  warn_of_overhang(pass, report);
  const vxm_engine *engine = pass->solid.engine;
  if (engine && engine->falls_back && !engine->ops)
    vxm_warn(warnings, "%s", engine->info.note);
  warn_of_hollow_overlaps(pass, report);
  warn_of_filled_overlaps(pass, report);
  if (report->contested > 0)
    warn_of_open(pass, report);
}

void vxm_model_report(vxm_model_pass *pass, vxm_voxelize_report *report, int64_t voxels, uint64_t hash) {
  const vxm_split *split = &pass->solid.analysis->triangles.split;
  *pass->warnings =
      (vxm_warnings){0}; /* a pass may be reported twice: for its grid, and for the file of that */
  *report = (vxm_voxelize_report){
      .parts = (int64_t)split->part_count,
      .closed_parts = (int64_t)split->kind_end[VXM_PART_CLOSED],
      .capped_parts = (int64_t)(split->kind_end[VXM_PART_CAPPED] - split->kind_end[VXM_PART_CLOSED]),
      .caps = (int64_t)split->capped_loops,
      .cavities = (int64_t)split->cavity_count,
      .contested = pass->solid.contested,
      .winding_decided = pass->solid.winding_decided,
      .voxels = voxels,
      .hash = hash,
      .components = (int64_t)split->component_count,
      .self_overlapping_parts = vxm_overlaps_wanted(pass->solid.analysis, &pass->solid.options)
                                    ? (int64_t)pass->solid.analysis->self_overlap.part_count
                                    : 0,
      .hollow_overlaps = vxm_fills_overlaps(&pass->solid.options)
                             ? (int64_t)pass->solid.analysis->self_overlap.hollow_count
                             : 0,
      .filled_overlaps = vxm_fills_overlaps(&pass->solid.options)
                             ? (int64_t)pass->solid.analysis->self_overlap.filled_count
                             : 0,
      .thin_voxels = pass->is_field ? 0 : pass->thin.thin.added};
  if (pass->thin.thin.area > 0)
    report->thin_share =
        fmin((double)pass->thin.thin.area / VXM_OFFSET_UNIT / surface_area(&pass->solid, false), 1);
  count_empty_parts(pass, report);
  warn(pass, report);
}
