/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/model/model.h"
#include "voxel/solid/confidence.h"
#include "voxel/solid/orient_by_vote.h"
#include "voxel/solid/outside_parts.h"
#include "voxel/surface/surface.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Making and freeing ---- */

static vxm_status make_shape(vxm_model *model, const vxm_soup *soup, vxm_error *error) {
  vxm_mesh_analysis *shape = &model->shape;
  const vxm_voxelize_options *options = &model->options;
  *shape = (vxm_mesh_analysis){.context = model->context, .soup = soup, .options = options};
  shape->open_turns.context = shape->all_turns.context = model->context;
  shape->workspace = vxm_workspace_of(model->context);
  model->run =
      (vxm_voxel_pass){.shape = shape, .placed = {.context = model->context}, .engine = options->engine};
  model->run.open_wound.context = model->run.all_wound.context = model->context;
  vxm_split_rule rule = {options->parts, options->cavities, vxm_caps_wanted(options)};
  vxm_status status = vxm_triangle_set_create(&shape->facets, soup, rule, error);
  if (status != VXM_OK)
    return status;
  if (shape->facets.facet_count == 0)
    return vxm_fail(error, VXM_ERROR_EMPTY,
                    "the mesh has no face with three different corners, so there is nothing to voxelize");
  vxm_error local = VXM_ERROR_INIT;
  model->run.has_voxels =
      vxm_calloc(model->context, shape->facets.split.part_count, sizeof *model->run.has_voxels, &local);
  if (!model->run.has_voxels)
    vxm_error_pass(error, &local);
  return local.code;
}

vxm_status vxm_model_make(vxm_model **out, const vxm_soup *soup, const vxm_voxelize_options *options,
                          vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_model *model = vxm_calloc(soup->context, 1, sizeof *model, &local);
  *out = NULL;
  if (!model) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  vxm_status status = vxm_context_acquire(&model->context, soup->context, error);
  model->labels.context = model->context;
  model->options = *options;
  if (status == VXM_OK)
    status = make_shape(model, soup, error);
  if (status != VXM_OK) {
    vxm_model_destroy(model);
    return status;
  }
  *out = model;
  return VXM_OK;
}

void vxm_model_destroy(vxm_model *model) {
  if (!model)
    return;
  vxm_context *context = model->context;
  vxm_label_table_destroy(&model->labels);
  vxm_free(context, model->run.has_voxels);
  vxm_voxel_pass_destroy(&model->run);
  vxm_shell_window_destroy(&model->shelling, context);
  vxm_surface_destroy(model->surface);
  vxm_flip_mask_destroy(&model->shape.open_turns);
  vxm_flip_mask_destroy(&model->shape.all_turns);
  vxm_workspace_destroy(&model->shape.workspace);
  vxm_triangle_set_destroy(&model->shape.facets);
  vxm_free(context, model);
  vxm_context_release(context);
}

static bool is_shell(const vxm_voxelize_options *options) {
  return options->surface >= VXM_SURFACE_SHELL26;
}

bool vxm_model_wants_faces(const vxm_model *model) {
  return model->options.mode != VXM_MODE_SOLID && !is_shell(&model->options);
}

bool vxm_model_wants_solid(const vxm_model *model) {
  return model->options.mode != VXM_MODE_SURFACE || is_shell(&model->options);
}

/** A shell alone; with the solid it is the solid. */
static bool wants_shell(const vxm_model *model) {
  return model->options.mode == VXM_MODE_SURFACE && is_shell(&model->options);
}

int vxm_model_windows_held(const vxm_model *model) {
  int buffers = vxm_model_wants_solid(model) ? vxm_voxel_pass_buffers(&model->shape) : 0;
  if (model->options
          .confidence) /* a byte per voxel, four voters, what is contested and what closed parts fill */
    buffers = 8 + 6;
  return 1 + wants_shell(model) + buffers;
}

/** What deciding open parts takes beside windows: patches and trees, the grids by which they are turned, and
 * slabs along slices. */
static uint64_t decision_bytes(const vxm_model *model, const vxm_window *shape) {
  const vxm_mesh_analysis *s = &model->shape;
  const vxm_triangle_set *facets = &s->facets;
  bool winding = model->options.method == VXM_METHOD_WINDING;
  size_t begin = winding ? 0 : vxm_voted_begin(s), end = facets->split.part_count;
  uint64_t threads = (uint64_t)vxm_context_threads(model->context);
  uint64_t bins = 5 * threads * (uint64_t)(shape->slow_dim + shape->middle_dim) * sizeof(vxm_crossing_bin);
  bool one = vxm_one_voter(&model->options);
  if (begin >= end && !one)
    return bins;
  uint64_t slabs = threads * shape->row_words * (uint64_t)shape->slow_dim * sizeof(uint64_t);
  if (one || !vxm_caps_wanted(&model->options))
    return bins + slabs;
  uint64_t triangles = begin < end ? facets->parts[end - 1].end - facets->parts[begin].begin : 0;
  return bins + slabs + triangles * VXM_TURNED_BYTES + VXM_ORIENT_BYTES;
}

vxm_memory_need vxm_model_memory_need(const vxm_model *model, const vxm_space *space, const vxm_window *shape,
                                      bool worst) {
  const vxm_triangle_set *facets = &model->shape.facets;
  uint64_t threads = (uint64_t)vxm_context_threads(model->context);
  uint64_t surface = vxm_model_wants_faces(model) ? vxm_surface_bytes(model->shape.soup, (int)threads) : 0;
  if (!vxm_model_wants_solid(model))
    return (vxm_memory_need){surface, vxm_model_windows_held(model)};
  bool polled = vxm_voted_begin(&model->shape) < facets->split.part_count;
  int voters = polled ? 4 : 1;
  const vxm_snapped_points *placed = &model->run.placed;
  uint64_t points = facets->point_count * (sizeof *placed->narrow + sizeof *placed->cells);
  uint64_t slab = (uint64_t)vxm_max(VXM_SLAB_WORDS, (int64_t)shape->slice_words) * sizeof(uint64_t);
  /* A slab for each voter and thread, some slices for what is carried on, and the bins themselves. */
  vxm_memory_need demand = {points + surface + (5 * threads + 4) * slab + (UINT64_C(1) << 20),
                            vxm_model_windows_held(model)};
  if (model->run.engine && model->run.engine->ops) { /* its buffers, and points and facets in them */
    enum { BUFFERS = 4, BUFFERS_OF_VOTES = 11, BYTES_PER_FACET = 32 };
    demand.windows += polled ? BUFFERS_OF_VOTES : BUFFERS;
    demand.fixed += facets->facet_count * BYTES_PER_FACET + points;
  }
  /* Chunks of records are half full at worst. */
  double bound = 2 * sizeof(uint64_t) * vxm_raster_schedule_bound(facets, space, NULL) * voters;
  double round = 2 * sizeof(uint64_t) * vxm_raster_schedule_round(model->context);
  if (worst) /* a bin keeps a slab of records of a part before it becomes a bitmap */
    demand.windows += 2 * voters * (int)threads;
  demand.fixed += decision_bytes(model, shape);
  double crossings = worst ? fmin(round, bound) : bound;
  demand.fixed += crossings < 0x1p62 ? (uint64_t)crossings : UINT64_C(1) << 62;
  if (wants_shell(model)) /* two slices more of the solid */
    demand.fixed += 2 * (uint64_t)demand.windows * shape->slice_words * sizeof(uint64_t);
  return demand;
}

/* ---- A run ---- */

static vxm_status check_transform(const double m[12], bool *mirrored, vxm_error *error) {
  for (int i = 0; i < 12; i++)
    if (!isfinite(m[i]))
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "voxelize: element %d of the transform is not finite", i);
  double determinant = 0;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    determinant += m[a] * (m[4 + b] * m[8 + c] - m[4 + c] * m[8 + b]);
  }
  if (determinant == 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "voxelize: the transform has determinant 0: it flattens the mesh");
  *mirrored = determinant < 0;
  return VXM_OK;
}

vxm_status vxm_model_begin(vxm_model *model, const vxm_space *space, const double transform[12],
                           uint8_t *confidence, vxm_error *error) {
  vxm_lattice lattice = vxm_lattice_of(space);
  return vxm_model_begin_on(model, &lattice, transform, confidence, error);
}

vxm_status vxm_model_begin_on(vxm_model *model, const vxm_lattice *lattice, const double transform[12],
                              uint8_t *confidence, vxm_error *error) {
  vxm_voxel_pass *run = &model->run;
  vxm_triangle_set *facets = &model->shape.facets;
  model->warnings = (vxm_warnings){0};
  model->space = lattice->space;
  run->mirrored = false;
  vxm_status status = transform ? check_transform(transform, &run->mirrored, error) : VXM_OK;
  if (status != VXM_OK)
    return status;
  for (size_t p = 0; p < facets->split.part_count; p++)
    atomic_store_explicit(&run->has_voxels[p], 0, memory_order_relaxed);
  run->confidence = confidence;
  run->contested = run->escalated = 0;
  run->added = false;
  vxm_winding_mesh_destroy(&run->open_wound);
  vxm_winding_mesh_destroy(&run->all_wound);
  vxm_shell_window_begin(&model->shelling);
  if (vxm_model_wants_solid(model))
    status = vxm_voxel_pass_place(run, lattice, transform, confidence != NULL, error);
  if (status != VXM_OK || !vxm_model_wants_faces(model))
    return status;
  if (model->surface)
    return vxm_surface_place(model->surface, lattice, transform, error);
  return vxm_surface_create(&model->surface, model->shape.soup, lattice, transform, error);
}

static vxm_status fill_solid(const vxm_window *window, void *payload, vxm_error *error) {
  vxm_voxel_pass *run = payload;
  vxm_status status = vxm_solid_fill(run, window, error);
  return status == VXM_OK && run->confidence ? vxm_confidence_fill(run, window, error) : status;
}

static vxm_status fill_shell(vxm_model *model, const vxm_window *window, vxm_error *error) {
  static const vxm_adjacency adjacency[] = {[VXM_SURFACE_SHELL26] = VXM_ADJACENT_26,
                                            [VXM_SURFACE_SHELL18] = VXM_ADJACENT_18,
                                            [VXM_SURFACE_SHELL6] = VXM_ADJACENT_6};
  return vxm_shell_window_fill(&model->shelling, window, adjacency[model->options.surface], fill_solid,
                               &model->run, model->context, error);
}

vxm_status vxm_model_fill(vxm_model *model, const vxm_window *window, vxm_error *error) {
  vxm_voxel_pass *run = &model->run;
  vxm_surface_kind kind = model->options.surface;
  if (wants_shell(model))
    return fill_shell(model, window, error);
  bool solid = vxm_model_wants_solid(model);
  vxm_status status = solid ? fill_solid(window, run, error) : VXM_OK;
  if (status != VXM_OK || !vxm_model_wants_faces(model))
    return status;
  if (solid && run->confidence)
    return vxm_surface_add_sure(model->surface, window, kind, run->confidence, error);
  if (run->confidence) /* exact everywhere */
    memset(run->confidence, 255,
           (size_t)window->fast_dim * (size_t)window->middle_dim * (size_t)window->slow_dim);
  return vxm_voxel_pass_surface(run, model->surface, window, kind, !solid, error);
}

/* ---- Report and warnings ---- */

/** A part that has facets, of which none set a voxel. */
static bool is_empty(const vxm_voxel_pass *run, size_t part) {
  const vxm_part *p = &run->shape->facets.parts[part];
  return p->begin < p->end && !atomic_load_explicit(&run->has_voxels[part], memory_order_relaxed);
}

/** The open parts count as empty if together they added nothing, whatever single voters held. */
static void count_empty_parts(vxm_model *model, vxm_voxelize_report *report) {
  vxm_voxel_pass *run = &model->run;
  const vxm_triangle_set *facets = &model->shape.facets;
  if (!vxm_one_voter(&model->options) && !run->added)
    for (size_t p = vxm_voted_begin(&model->shape); p < facets->split.part_count; p++)
      atomic_store_explicit(&run->has_voxels[p], 0, memory_order_relaxed);
  bool placed = vxm_model_wants_solid(model) && (run->placed.narrow || run->placed.wide);
  for (size_t p = 0; p < facets->split.part_count && placed; p++)
    if (is_empty(run, p)) {
      bool outside = vxm_part_is_outside(run, p);
      report->outside_parts += outside;
      report->empty_parts += !outside;
    }
}

/** The first few parts that set no voxel, inside or outside of the grid, each by one of its vertices. */
static const char *name_parts(const vxm_model *model, bool outside, int64_t count, char names[200]) {
  enum { NAMED = 3 };
  size_t used = 0;
  int named = 0;
  const vxm_triangle_set *facets = &model->shape.facets;
  names[0] = '\0';
  for (size_t p = 0; p < facets->split.part_count && named < NAMED; p++) {
    if (!is_empty(&model->run, p) || vxm_part_is_outside(&model->run, p) != outside)
      continue;
    const double *at = facets->positions[facets->corners[facets->parts[p].begin][0]];
    used += (size_t)snprintf(names + used, 200 - used, "%s(%.4g, %.4g, %.4g)", named ? ", " : "", at[0],
                             at[1], at[2]);
    named++;
  }
  if (count > named)
    snprintf(names + used, 200 - used, ", ...");
  return names;
}

static void warn_of_empty_parts(vxm_model *model, const vxm_voxelize_report *report) {
  char names[200];
  if (report->empty_parts > 0 && report->voxels > 0 && !vxm_model_wants_faces(model))
    vxm_warn(&model->warnings,
             "%" PRId64 " of %" PRId64
             " parts hold no voxel centre, being thinner than a voxel or open sheets: those at "
             "%s; --mode both keeps them, and so may a higher resolution (-r)",
             report->empty_parts, report->parts, name_parts(model, false, report->empty_parts, names));
  if (report->outside_parts > 0 && report->voxels > 0)
    vxm_warn(&model->warnings,
             "%" PRId64 " of %" PRId64 " parts lie outside of the grid: those at %s; see --bounds and --like",
             report->outside_parts, report->parts, name_parts(model, true, report->outside_parts, names));
}

static void warn(vxm_model *model, const vxm_voxelize_report *report) {
  vxm_warnings *warnings = &model->warnings;
  bool faces = vxm_model_wants_faces(model);
  if (report->voxels == 0 && faces)
    vxm_warn(warnings, "no face meets the grid: check --bounds or --like");
  else if (report->voxels == 0 && report->outside_parts > 0 && report->empty_parts == 0)
    vxm_warn(warnings, "the model lies outside of the grid: check --bounds or --like");
  else if (report->voxels == 0)
    vxm_warn(warnings,
             "no voxel centre is inside: the model is open, flat or thinner than a voxel; try --mode both "
             "or a higher resolution (-r)");
  warn_of_empty_parts(model, report);
  const vxm_engine *engine = model->run.engine;
  if (engine && engine->falls_back && !engine->ops)
    vxm_warn(warnings, "%s", engine->info.note);
  if (report->contested > 0)
    vxm_warn(warnings,
             "the model is open (%zu odd edges) and x, y and z disagree on %" PRId64
             " voxels, decided by %s; "
             "compare --method winding, --vote majority and --parts whole",
             model->shape.facets.split.odd_edge_count, report->contested,
             report->escalated > 0 ? "the winding number" : "the vote");
}

void vxm_model_end(vxm_model *model, vxm_voxelize_report *report, int64_t voxels, uint64_t hash) {
  const vxm_split *split = &model->shape.facets.split;
  model->warnings = (vxm_warnings){0}; /* a run may be ended twice: for its grid, and for the file of that */
  *report = (vxm_voxelize_report){
      .parts = (int64_t)split->part_count,
      .closed_parts = (int64_t)split->kind_end[VXM_PART_CLOSED],
      .capped_parts = (int64_t)(split->kind_end[VXM_PART_CAPPED] - split->kind_end[VXM_PART_CLOSED]),
      .caps = (int64_t)split->capped_loops,
      .cavities = (int64_t)split->cavity_count,
      .contested = model->run.contested,
      .escalated = model->run.escalated,
      .voxels = voxels,
      .hash = hash};
  count_empty_parts(model, report);
  warn(model, report);
}
