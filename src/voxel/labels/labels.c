/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels/labels.h"
#include "base/threads.h"
#include "grid/count_hash.h"
#include "mesh/geometry.h"
#include "voxel/fields/field.h"
#include "voxel/labels/label_overlaps.h"
#include "voxel/model/model_report.h"

#include <string.h>

typedef struct labels {
  vxm_context *context;
  vxm_model *model;
  vxm_model_pass *pass; /**< NULL before the solid is made */
  vxm_face_labels *labelling;
  vxm_label_overlaps claims;
  vxm_row_tile whole;             /**< all rows and slices */
  atomic_int_fast64_t unassigned; /**< set voxels that no label claims */
  int64_t contested;
  atomic_bool has_open;        /**< voxels have an open label: `claims.several` from then on */
  const uint8_t *open;         /**< while these are settled, who takes them */
  atomic_int_fast64_t *counts; /**< of each label, the voxels that have it */
  vxm_task_progress progress;
} labels;

static size_t grid_words(const labels *l) {
  return l->claims.set.slice_words * (size_t)l->claims.set.slow_dim;
}

/* ---- The voxels of the model ---- */

static vxm_status fill_set(labels *l, const vxm_field_plan *plan, vxm_count_hash *sum, vxm_error *error) {
  const vxm_space *space = &l->claims.lattice.space;
  const vxm_window *set = &l->claims.set;
  vxm_status status = vxm_model_begin(&l->pass, l->model, space, NULL, NULL, error);
  vxm_window part = *set;
  for (int64_t begin = 0; begin < set->slow_dim && status == VXM_OK; begin = part.end) {
    part.begin = begin;
    part.end = vxm_min(begin + plan->slices, set->slow_dim);
    part.words = set->words + (size_t)begin * set->slice_words;
    status = vxm_model_pass_fill(l->pass, &part, error);
  }
  *sum = vxm_count_hash_start(space);
  if (status == VXM_OK)
    vxm_count_hash_add(sum, l->context, set, NULL);
  return status;
}

static void clear_tile(size_t task, int worker, void *payload) {
  (void)worker;
  const labels *l = payload;
  vxm_row_tile tile = vxm_row_tiles_at(&l->whole, task);
  size_t count = (size_t)((tile.end[0] - tile.begin[0]) * l->claims.set.fast_dim);
  for (int64_t slow = tile.begin[1]; slow < tile.end[1]; slow++)
    memset(vxm_label_overlaps_row(&l->claims, tile.begin[0], slow), 0, count * sizeof *l->claims.values);
}

/* ---- What no label claims ---- */

/** Leaves of the set voxels of a row those without a label, and of `several` those with an open one; returns
 * how many are left without. */
static int64_t leave_row(const vxm_label_overlaps *c, int64_t middle, int64_t slow, uint64_t *any_open) {
  const uint16_t *values = vxm_label_overlaps_row(c, middle, slow);
  uint64_t *words = vxm_window_row(&c->set, middle, slow), *opened = c->several + (words - c->set.words);
  int64_t left = 0;
  for (size_t w = 0; w < c->set.row_words; w++) {
    opened[w] = 0;
    for (uint64_t bits = words[w]; bits; bits &= bits - 1) {
      uint16_t value = values[64 * w + (size_t)__builtin_ctzll(bits)];
      words[w] ^= value ? bits & -bits : 0;
      opened[w] |= c->open && value && c->open[value - 1] ? bits & -bits : 0;
    }
    *any_open |= opened[w];
    left += vxm_popcount(words[w]);
  }
  return left;
}

static void leave_tile(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  vxm_row_tile tile = vxm_row_tiles_at(&l->whole, task);
  int64_t left = 0;
  uint64_t any_open = 0;
  for (int64_t slow = tile.begin[1]; slow < tile.end[1]; slow++)
    for (int64_t middle = tile.begin[0]; middle < tile.end[0]; middle++)
      left += leave_row(&l->claims, middle, slow, &any_open);
  atomic_fetch_add_explicit(&l->unassigned, left, memory_order_relaxed);
  if (any_open)
    atomic_store_explicit(&l->has_open, true, memory_order_relaxed);
}

static void settle_tile(size_t task, int worker, void *payload) {
  static const int64_t nowhere[3] = {0, 0, 0};
  labels *l = payload;
  const vxm_label_overlaps *c = &l->claims;
  if (vxm_task_progress_stopped(&l->progress, worker))
    return;
  vxm_row_tile tile = vxm_row_tiles_at(&l->whole, task);
  const size_t row = (size_t)c->set.fast_dim, plane = row * (size_t)c->set.middle_dim;
  vxm_window asked = c->set;
  asked.words = l->open ? c->several : c->set.words;
  vxm_nearest_label nearest = {c->bvh, &c->lattice.space, &asked, nowhere, c->values, row, plane, 0, l->open};
  const int64_t begin[3] = {0, tile.begin[0], tile.begin[1]},
                end[3] = {c->set.fast_dim, tile.end[0], tile.end[1]};
  vxm_nearest_label_voxels(&nearest, begin, end);
  vxm_task_progress_step(&l->progress);
}

/** Gives what is left of the set voxels, or those with an open label, to the nearest label. */
static vxm_status settle(labels *l, vxm_error *error) {
  size_t tiles = vxm_row_tiles_count(&l->whole);
  vxm_status status = vxm_label_overlaps_need_bvh(&l->claims, error);
  if (status != VXM_OK)
    return status;
  vxm_task_progress_start(&l->progress, l->context, "labelling", tiles, error);
  vxm_parallel(l->context, tiles, settle_tile, l);
  return vxm_task_progress_end(&l->progress);
}

static vxm_status settle_unassigned(labels *l, vxm_error *error) {
  for (size_t w = 0; w < grid_words(l); w++)
    l->contested += vxm_popcount(l->claims.several[w]);
  vxm_parallel(l->context, vxm_row_tiles_count(&l->whole), leave_tile, l);
  return atomic_load_explicit(&l->unassigned, memory_order_relaxed) > 0 ? settle(l, error) : VXM_OK;
}

/* ---- What open labels have ---- */

/** Near the surface open labels take voxels of each other where they have the nearest face. */
static vxm_status settle_open(labels *l, vxm_error *error) {
  if (!atomic_load_explicit(&l->has_open, memory_order_relaxed))
    return VXM_OK;
  l->open = l->claims.open;
  return settle(l, error);
}

/* ---- Counts ---- */

static void count_tile(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  vxm_row_tile tile = vxm_row_tiles_at(&l->whole, task);
  for (int64_t slow = tile.begin[1]; slow < tile.end[1]; slow++) {
    const uint16_t *at = vxm_label_overlaps_row(&l->claims, tile.begin[0], slow),
                   *last = vxm_label_overlaps_row(&l->claims, tile.end[0], slow);
    while (at < last) {
      const uint16_t *run = at++;
      while (at < last && *at == *run)
        at++;
      if (*run)
        atomic_fetch_add_explicit(&l->counts[*run - 1], at - run, memory_order_relaxed);
    }
  }
}

/** Whether a part is wound inward, as the skin of a cavity is, which has no voxel of its own. */
static bool is_cavity(const vxm_face_labels *labelling, size_t label) {
  const vxm_soup *soup = labelling->soup;
  const uint32_t *faces = &labelling->faces[labelling->begin[label - 1]];
  size_t face_count = labelling->begin[label] - labelling->begin[label - 1], count = 0;
  const uint32_t *corner = face_count > 0 ? vxm_face(soup, faces[0], &count) : NULL;
  double volume = 0;
  for (size_t i = 0; labelling->is_by_part && count > 0 && i < face_count; i++)
    volume += vxm_face_cone(NULL, soup, faces[i], vxm_position(soup, corner[0]), 1);
  return volume < 0;
}

void vxm_labels_warn(const vxm_face_labels *labelling, int64_t voxels, vxm_warnings *warnings) {
  const vxm_label_table *table = &labelling->table;
  size_t empty = 0, first = 0;
  for (size_t label = table->count; label > 0; label--)
    if (table->voxels[label - 1] == 0 && !is_cavity(labelling, label)) {
      empty++;
      first = label;
    }
  if (labelling->is_untagged)
    vxm_warn(warnings, "the mesh names no groups or materials: all of it has one label, \"unnamed\"");
  if (empty > 0 && voxels > 0)
    vxm_warn(warnings, "%zu of %zu labels have no voxel, the first of them label %zu, \"%.80s\"", empty,
             table->count, first, vxm_label_table_name(table, first));
}

static void sum_up(labels *l, vxm_label_report *report, const vxm_count_hash *sum) {
  vxm_label_table *table = &l->labelling->table;
  vxm_parallel(l->context, vxm_row_tiles_count(&l->whole), count_tile, l);
  for (size_t label = 0; label < table->count; label++)
    table->voxels[label] = atomic_load_explicit(&l->counts[label], memory_order_relaxed);
  *report = (vxm_label_report){.voxelize = report->voxelize, .labels = (int64_t)table->count};
  report->unassigned = atomic_load_explicit(&l->unassigned, memory_order_relaxed);
  report->contested = l->contested;
  vxm_model_report(l->pass, report->voxelize, sum->count, sum->hash);
  vxm_labels_warn(l->labelling, sum->count, l->pass->warnings);
}

/* ---- All of it ---- */

static vxm_status allocate(labels *l, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  l->claims.set.words = vxm_alloc(l->context, grid_words(l), sizeof *l->claims.set.words, &local);
  l->claims.several = vxm_calloc(l->context, grid_words(l), sizeof *l->claims.several, &local);
  l->counts = vxm_calloc(l->context, l->labelling->table.count, sizeof *l->counts, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

static vxm_status plan_slices(vxm_field_plan *plan, const labels *l, vxm_error *error) {
  uint64_t fixed = 2 * (uint64_t)grid_words(l) * sizeof(uint64_t) + vxm_label_overlaps_bytes(&l->claims) +
                   l->labelling->table.count * sizeof *l->counts;
  return vxm_field_plan_of(plan, l->model, &l->claims.lattice.space, l->claims.set.layout, 1, false, fixed, 0,
                           1, error);
}

static vxm_status run(labels *l, vxm_label_report *report, vxm_error *error) {
  vxm_field_plan plan;
  vxm_count_hash sum;
  vxm_status status = vxm_label_overlaps_begin(&l->claims, error);
  if (status == VXM_OK)
    status = plan_slices(&plan, l, error);
  if (status == VXM_OK)
    status = allocate(l, error);
  if (status == VXM_OK)
    status = fill_set(l, &plan, &sum, error);
  if (status == VXM_OK) {
    vxm_parallel(l->context, vxm_row_tiles_count(&l->whole), clear_tile, l);
    status = vxm_label_overlaps_run(&l->claims, error);
  }
  if (status == VXM_OK)
    status = settle_unassigned(l, error);
  if (status == VXM_OK)
    status = settle_open(l, error);
  if (status == VXM_OK)
    sum_up(l, report, &sum);
  return status;
}

static void destroy(labels *l) {
  vxm_model_close(l->model, l->pass);
  vxm_label_overlaps_end(&l->claims);
  vxm_free(l->context, l->counts);
  vxm_free(l->context, l->claims.several);
  vxm_free(l->context, l->claims.set.words);
  vxm_free(l->context, l);
}

vxm_status vxm_labels_run(uint16_t *values, vxm_layout layout, vxm_label_report *report, vxm_model *model,
                          const vxm_space *space, vxm_face_labels *labelling, vxm_error *error) {
  vxm_context *context = model->context;
  vxm_error local = VXM_ERROR_INIT;
  vxm_model_result *mine;
  vxm_status status = vxm_model_results_mine(&mine, model->results, error);
  if (status != VXM_OK)
    return status;
  vxm_label_table_destroy(&mine->labels);
  labels *l = vxm_calloc(context, 1, sizeof *l, &local);
  status = local.code;
  if (l) {
    l->context = context;
    l->model = model;
    l->labelling = labelling;
    l->whole.end[0] = space->dims[layout.middle];
    l->whole.end[1] = space->dims[layout.slow];
    vxm_label_overlaps *c = &l->claims;
    c->context = c->pieces.context = context;
    c->options = &model->options;
    c->lattice = vxm_lattice_of(space);
    c->labelling = labelling;
    c->set = vxm_window_of(space, layout, 0, space->dims[layout.slow]);
    c->values = values;
    status = run(l, report, &local);
    destroy(l);
  }
  if (status == VXM_OK) {
    mine->labels = labelling->table;
    labelling->table = (vxm_label_table){.context = context};
  } else
    vxm_error_pass(error, &local);
  return status;
}
