/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/voxelize.h"
#include "voxel/confidence.h"
#include "voxel/outward.h"
#include "voxel/parity.h"
#include "voxel/settle.h"
#include "voxel/surface.h"
#include "voxel/tetra.h"
#include "voxel/vote.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

/** The voters of parts that are not closed: x, y, z, and the tetrahedra by parity with cones. */
enum { VOTERS = 4 };

typedef struct solid {
  const vxm_voxelize_options *options;
  vxm_voxelize_report *report;
  vxm_context *context;
  const vxm_soup *soup;
  vxm_grid *grid;
  vxm_lattice lattice;
  vxm_facets facets;
  atomic_uchar *touched;
  vxm_grid *settled; /**< voxels that the winding number decided, or NULL */
  vxm_grid *closed;  /**< what the closed parts fill; only kept for the confidence */
} solid;

static size_t kind_end(const solid *s, vxm_part_kind kind) {
  return s->facets.split.kind_end[kind];
}

static vxm_unite_job job_for(const solid *s, int axis, size_t part_begin, size_t part_end, unsigned roles) {
  static const char *const phase[3] = {"voxelizing along x", "voxelizing along y", "voxelizing along z"};
  return (vxm_unite_job){.facets = &s->facets,
                         .lattice = &s->lattice,
                         .axes = vxm_axes_of(axis),
                         .part_begin = part_begin,
                         .part_end = part_end,
                         .roles = roles,
                         .touched = s->touched,
                         .phase = phase[axis]};
}

static vxm_status new_grid(const solid *s, vxm_grid **out, vxm_error *error) {
  return vxm_grid_create(out, s->context, &s->lattice.space, error);
}

/* ---- Parts that are closed, or closed by caps: one axis settles them ---- */

static vxm_status unite_closed_parts(solid *s, vxm_error *error) {
  vxm_unite_job job = job_for(s, 0, 0, kind_end(s, VXM_PART_CLOSED), VXM_FACET_TRIANGLE);
  vxm_status status = vxm_parity_unite(s->grid, &job, error);
  if (status != VXM_OK || !s->options->confidence)
    return status;
  status = new_grid(s, &s->closed, error);
  if (status == VXM_OK)
    memcpy(s->closed->words, s->grid->words, s->grid->word_count * sizeof *s->grid->words);
  return status;
}

static vxm_status unite_capped_parts(solid *s, vxm_error *error) {
  vxm_unite_job job = job_for(s, 0, kind_end(s, VXM_PART_CLOSED), kind_end(s, VXM_PART_CAPPED),
                              VXM_FACET_TRIANGLE | VXM_FACET_CAP);
  return vxm_parity_unite(s->grid, &job, error);
}

/* ---- Parts that stay open: votes ---- */

static void destroy_voters(vxm_grid *voters[VOTERS]) {
  for (int v = 0; v < VOTERS; v++)
    vxm_grid_destroy(voters[v]);
}

/** Fills the first `count` voters over all parts from part_begin on. */
static vxm_status fill_voters(solid *s, vxm_grid *voters[VOTERS], int count, size_t part_begin,
                              vxm_error *error) {
  vxm_status status = VXM_OK;
  for (int v = 0; v < count && status == VXM_OK; v++) {
    status = new_grid(s, &voters[v], error);
    if (status != VXM_OK)
      break;
    vxm_unite_job job = job_for(s, v < 3 ? v : 0, part_begin, s->facets.split.part_count, VXM_FACET_TRIANGLE);
    if (v == 3)
      job.roles |= VXM_FACET_CONE;
    status = vxm_parity_unite(voters[v], &job, error);
  }
  return status;
}

static vxm_status vote_by_rule(solid *s, vxm_error *error) {
  vxm_grid *voters[VOTERS] = {NULL};
  vxm_status status = fill_voters(s, voters, VOTERS, kind_end(s, VXM_PART_CLOSED), error);
  if (status == VXM_OK)
    vxm_vote_combine(s->grid, voters, s->options->vote, &s->report->contested);
  destroy_voters(voters);
  return status;
}

/* ---- The winding number ---- */

/** Decides `asked` (NULL = all voxels) by the winding number of parts from part_begin on. */
static vxm_status decide_by_winding(solid *s, vxm_grid *out, const vxm_grid *asked, size_t part_begin,
                                    const vxm_grid *const voters[3], vxm_error *error) {
  vxm_outward outward;
  vxm_winding *winding = NULL;
  vxm_status status = vxm_outward_create(&outward, &s->facets, &s->lattice, part_begin,
                                         s->facets.split.part_count, voters, error);
  if (status != VXM_OK)
    return status;
  status = vxm_winding_create(&winding, s->context, outward.triangles, outward.count, error);
  if (status == VXM_OK)
    status = vxm_settle(out, asked, winding, s->grid->confidence, error);
  vxm_winding_destroy(winding);
  vxm_outward_destroy(&outward);
  return status;
}

static vxm_status agree_or_decide(solid *s, vxm_error *error) {
  size_t begin = kind_end(s, VXM_PART_CAPPED);
  vxm_grid *voters[VOTERS] = {NULL};
  vxm_status status = fill_voters(s, voters, 3, begin, error);
  if (status == VXM_OK)
    status = new_grid(s, &s->settled, error);
  if (status == VXM_OK)
    vxm_vote_agree(s->grid, voters, s->settled, &s->report->contested);
  if (status == VXM_OK && s->report->contested > 0) {
    const vxm_grid *const three[3] = {voters[0], voters[1], voters[2]};
    status = decide_by_winding(s, s->grid, s->settled, begin, three, error);
    s->report->escalated = s->report->contested;
  }
  destroy_voters(voters);
  return status;
}

/** Every voxel by the winding number; which way patches face is read from the solid that was made before. */
static vxm_status fill_by_winding(solid *s, vxm_error *error) {
  vxm_grid *all = NULL;
  vxm_status status = new_grid(s, &all, error);
  if (status == VXM_OK) {
    const vxm_grid *const same[3] = {s->grid, s->grid, s->grid};
    status = decide_by_winding(s, all, NULL, 0, same, error);
  }
  if (status == VXM_OK) {
    memcpy(s->grid->words, all->words, all->word_count * sizeof *all->words);
    const int64_t *dims = s->lattice.space.dims;
    s->report->escalated = dims[0] * dims[1] * dims[2];
  }
  vxm_grid_destroy(all);
  return status;
}

/* ---- Methods ---- */

static vxm_status unite_all_parts(solid *s, vxm_method method, vxm_error *error) {
  int axis = method == VXM_METHOD_TETRA ? 0 : (int)method - VXM_METHOD_X;
  vxm_unite_job job = job_for(s, axis, 0, s->facets.split.part_count, VXM_FACET_TRIANGLE);
  if (method != VXM_METHOD_TETRA)
    return vxm_parity_unite(s->grid, &job, error);
  job.phase = "voxelizing tetrahedra";
  return vxm_tetra_unite(s->grid, &job, error);
}

/** Whether holes are capped: only where no rule of the papers was asked for. */
static bool caps_are_wanted(const vxm_voxelize_options *options) {
  return options->method == VXM_METHOD_WINDING ||
         (options->method == VXM_METHOD_VOTE && options->vote == VXM_VOTE_AUTO);
}

/** The open parts count as empty if together they added nothing, whatever single voters held. */
static void note_open_parts(solid *s, int64_t voxels_before) {
  if (vxm_grid_count(s->grid) > voxels_before)
    return;
  for (size_t p = kind_end(s, VXM_PART_CAPPED); p < s->facets.split.part_count; p++)
    atomic_store_explicit(&s->touched[p], 0, memory_order_relaxed);
}

static vxm_status decide_open_parts(solid *s, vxm_error *error) {
  if (kind_end(s, VXM_PART_CAPPED) == s->facets.split.part_count)
    return VXM_OK;
  int64_t before = vxm_grid_count(s->grid);
  vxm_status status = caps_are_wanted(s->options) ? agree_or_decide(s, error) : vote_by_rule(s, error);
  if (status == VXM_OK)
    note_open_parts(s, before);
  return status;
}

static vxm_status fill(solid *s, vxm_error *error) {
  const vxm_voxelize_options *options = s->options;
  if (options->method != VXM_METHOD_VOTE && options->method != VXM_METHOD_WINDING)
    return unite_all_parts(s, options->method, error);
  vxm_status status = unite_closed_parts(s, error);
  if (status == VXM_OK)
    status = unite_capped_parts(s, error);
  if (status == VXM_OK)
    status = decide_open_parts(s, error);
  if (status == VXM_OK && options->method == VXM_METHOD_WINDING)
    status = fill_by_winding(s, error);
  return status;
}

/** The confidence of what the winding number did not decide. */
static vxm_status complete_confidence(solid *s, vxm_error *error) {
  if (!s->options->confidence || s->options->method == VXM_METHOD_WINDING)
    return VXM_OK;
  size_t begin = s->closed ? kind_end(s, VXM_PART_CLOSED) : 0;
  if (begin == s->facets.split.part_count) {
    vxm_confidence_fill(s->grid->confidence, s->grid, s->grid, NULL, NULL);
    return VXM_OK;
  }
  vxm_grid *voters[VOTERS] = {NULL};
  vxm_status status = s->closed ? VXM_OK : new_grid(s, &s->closed, error);
  atomic_uchar *touched = s->touched;
  s->touched = NULL; /* what these voters see says nothing about the result */
  if (status == VXM_OK)
    status = fill_voters(s, voters, VOTERS, begin, error);
  s->touched = touched;
  if (status == VXM_OK)
    vxm_confidence_fill(s->grid->confidence, s->grid, s->closed, voters, s->settled);
  destroy_voters(voters);
  return status;
}

/* ---- Report and warnings ---- */

static void fill_report(solid *s) {
  vxm_voxelize_report *report = s->report;
  const vxm_split *split = &s->facets.split;
  report->parts = (int64_t)split->part_count;
  report->closed_parts = (int64_t)kind_end(s, VXM_PART_CLOSED);
  report->capped_parts = (int64_t)(kind_end(s, VXM_PART_CAPPED) - kind_end(s, VXM_PART_CLOSED));
  report->caps = (int64_t)split->capped_loops;
  report->cavities = (int64_t)split->cavity_count;
  vxm_grid_sum(s->grid, &report->voxels, &report->hash);
  for (size_t p = 0; p < split->part_count && s->options->mode != VXM_MODE_SURFACE; p++)
    report->empty_parts += s->facets.parts[p].begin < s->facets.parts[p].end &&
                           !atomic_load_explicit(&s->touched[p], memory_order_relaxed);
}

/** The first few parts without volume, each by one of its vertices. */
static void name_empty_parts(solid *s) {
  enum { NAMED = 3 };
  char names[200] = "";
  int used = 0, named = 0;
  for (size_t p = 0; p < s->facets.split.part_count && named < NAMED; p++) {
    const vxm_part *part = &s->facets.parts[p];
    if (atomic_load_explicit(&s->touched[p], memory_order_relaxed) || part->begin == part->end)
      continue;
    uint32_t vertex = s->facets.facets[part->begin].corner[0];
    const double *at = vxm_position(s->soup, vertex);
    used += snprintf(names + used, sizeof names - (size_t)used, "%s(%.4g, %.4g, %.4g)", named ? ", " : "",
                     at[0], at[1], at[2]);
    named++;
  }
  vxm_note(&s->grid->notes,
           "%" PRId64 " of %" PRId64
           " parts hold no voxel centre, being thinner than a voxel or open sheets: those at "
           "%s%s; --mode both keeps them, and so may a higher resolution (-r)",
           s->report->empty_parts, s->report->parts, names, s->report->empty_parts > named ? ", ..." : "");
}

static void warn(solid *s) {
  const vxm_voxelize_report *report = s->report;
  vxm_notes *notes = &s->grid->notes;
  if (report->voxels == 0 && s->options->mode != VXM_MODE_SOLID)
    vxm_note(notes, "no face meets the grid: check --bounds or --like");
  else if (report->voxels == 0)
    vxm_note(notes,
             "no voxel centre is inside: the model is open, flat or thinner than a voxel; try --mode both "
             "or a higher resolution (-r)");
  else if (report->empty_parts > 0 && s->options->mode == VXM_MODE_SOLID)
    name_empty_parts(s);
  if (report->contested > 0)
    vxm_note(notes,
             "the model is open (%zu odd edges) and x, y and z disagree on %" PRId64
             " voxels, decided by %s; "
             "compare --method winding, --vote majority and --parts whole",
             s->facets.split.odd_edge_count, report->contested,
             report->escalated > 0 ? "the winding number" : "the vote");
}

/** The grids that will be needed at once, checked before they are made. */
static vxm_status check_memory(const solid *s, vxm_error *error) {
  const vxm_split *split = &s->facets.split;
  const vxm_voxelize_options *options = s->options;
  bool solid_wanted = options->mode != VXM_MODE_SURFACE;
  bool closed = kind_end(s, VXM_PART_CLOSED) == split->part_count;
  bool decided = closed || (caps_are_wanted(options) && kind_end(s, VXM_PART_CAPPED) == split->part_count);
  bool voted = options->method == VXM_METHOD_VOTE || options->method == VXM_METHOD_WINDING;
  uint64_t grids = 1, voters = solid_wanted && voted && !decided ? VOTERS : 0;
  if (solid_wanted && options->method == VXM_METHOD_WINDING && voters == 0)
    voters = 1;
  if (options->confidence) {
    grids += 8; /* a byte per voxel is eight bits */
    if (solid_wanted && options->method != VXM_METHOD_WINDING)
      voters = closed ? 1 : 1 + VOTERS;
  }
  return vxm_memory_check(s->context, (grids + voters) * vxm_space_bytes(&s->lattice.space), "voxelizing",
                          error);
}

static vxm_status prepare(solid *s, const vxm_space *space, vxm_error *error) {
  const vxm_voxelize_options *options = s->options;
  vxm_split_rule rule = {options->parts, options->cavities, caps_are_wanted(options)};
  vxm_status status = vxm_facets_create(&s->facets, s->soup, &s->lattice, rule, error);
  if (status != VXM_OK)
    return status;
  if (s->facets.facet_count == 0)
    return vxm_fail(error, VXM_ERROR_EMPTY,
                    "the mesh has no face with three different corners, so there is nothing to voxelize");
  status = check_memory(s, error);
  if (status == VXM_OK)
    status = vxm_grid_create(&s->grid, s->context, space, error);
  if (status != VXM_OK)
    return status;
  vxm_error local = VXM_ERROR_INIT;
  const int64_t *dims = space->dims;
  s->touched = vxm_calloc(s->context, s->facets.split.part_count, sizeof *s->touched, &local);
  if (s->touched && options->confidence)
    s->grid->confidence = vxm_calloc(s->context, (size_t)dims[0] * (size_t)dims[1], (size_t)dims[2], &local);
  if (local.code != VXM_OK && error)
    *error = local;
  return local.code;
}

vxm_status vxm_voxelize_run(vxm_grid **out, vxm_voxelize_report *report, const vxm_soup *soup,
                            const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error) {
  *out = NULL;
  solid s = {.options = options,
             .report = report,
             .context = soup->context,
             .soup = soup,
             .lattice = vxm_lattice_of(space)};
  vxm_status status = prepare(&s, space, error);
  if (status == VXM_OK && options->mode != VXM_MODE_SURFACE)
    status = fill(&s, error);
  if (status == VXM_OK && options->mode != VXM_MODE_SURFACE)
    status = complete_confidence(&s, error);
  if (status == VXM_OK && options->mode == VXM_MODE_SURFACE && s.grid->confidence)
    vxm_confidence_fill(s.grid->confidence, s.grid, s.grid, NULL, NULL); /* exact everywhere */
  if (status == VXM_OK && options->mode != VXM_MODE_SOLID)
    status = vxm_surface_unite(s.grid, soup, &s.lattice, s.grid->confidence, error);
  if (status == VXM_OK) {
    fill_report(&s);
    warn(&s);
    *out = s.grid;
    s.grid = NULL;
  }
  vxm_grid_destroy(s.closed);
  vxm_grid_destroy(s.settled);
  vxm_grid_destroy(s.grid);
  vxm_free(s.context, s.touched);
  vxm_facets_destroy(&s.facets);
  return status;
}
