/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels.h"
#include "base/threads.h"
#include "base/watch.h"
#include "grid/sum.h"
#include "voxel/award.h"
#include "voxel/field.h"
#include "voxel/piece_solid.h"

#include <string.h>

enum {
  TILE = 16, /**< rows and slices of a tile, which is one thread's: no two write the same voxel */
  BATCH = 256,
  BATCH_WORDS = 1 << 18, /**< of a batch of small pieces: 2 MiB */
  SMALL_WORDS = 1 << 12,
  SMALL_FACES = 1 << 11
};

/** The solid of a piece at hand. */
typedef struct solid {
  const vxm_piece *piece;
  vxm_window window;
  int64_t first[3]; /**< voxel of the space at which the box begins, in the order of the layout */
  atomic_bool is_contested;
} solid;

typedef struct labels {
  vxm_context *context;
  vxm_model *model;
  const vxm_space *space;
  vxm_lattice lattice;
  vxm_labelling *labelling;
  uint16_t *values;
  vxm_window set;     /**< the voxels of the model; in the end those without a label */
  uint64_t *several;  /**< voxels that more than one label claims */
  vxm_forest *forest; /**< NULL = not needed so far */
  vxm_pieces pieces;
  vxm_piece_desk *desks; /**< of each thread */
  uint64_t *words;       /**< of the solids at hand */
  size_t batch;          /**< how many these are: one, or small ones, each made by one thread */
  solid solids[BATCH];
  int64_t begin[2], end[2]; /**< rows and slices that are cut into tiles */
  atomic_bool has_failed;
  vxm_error *errors; /**< of each thread */
  atomic_int_fast64_t unclaimed;
  atomic_int_fast64_t *counts; /**< of each label, the voxels that have it */
  vxm_watch watch;
} labels;

static size_t grid_words(const labels *l) {
  return l->set.slice_words * (size_t)l->set.slow_dim;
}

/* ---- Tiles ---- */

/** Rows and slices begin..end-1. */
typedef struct tile {
  int64_t begin[2], end[2];
} tile;

static size_t tiles_across(const labels *l, int axis) {
  return (size_t)((l->end[axis] - l->begin[axis] + TILE - 1) / TILE);
}

static size_t tile_count(const labels *l) {
  return tiles_across(l, 0) * tiles_across(l, 1);
}

static tile tile_at(const labels *l, size_t task) {
  size_t across = tiles_across(l, 0), at[2] = {task % across, task / across};
  tile t;
  for (int a = 0; a < 2; a++) {
    t.begin[a] = l->begin[a] + (int64_t)at[a] * TILE;
    t.end[a] = vxm_min(t.begin[a] + TILE, l->end[a]);
  }
  return t;
}

static void tile_all(labels *l) {
  l->begin[0] = l->begin[1] = 0;
  l->end[0] = l->set.middle_dim;
  l->end[1] = l->set.slow_dim;
}

/** The part of a tile that a box has, as rows and slices of the box; false if there is none. */
static bool part_of(tile *out, const tile *t, const solid *s) {
  const int64_t dims[2] = {s->window.middle_dim, s->window.slow_dim};
  for (int a = 0; a < 2; a++) {
    out->begin[a] = vxm_max(t->begin[a] - s->first[a + 1], 0);
    out->end[a] = vxm_min(t->end[a] - s->first[a + 1], dims[a]);
    if (out->begin[a] >= out->end[a])
      return false;
  }
  return true;
}

/** Values of a row of the space. */
static uint16_t *value_row(const labels *l, int64_t middle, int64_t slow) {
  return l->values + (size_t)(slow * l->set.middle_dim + middle) * (size_t)l->set.fast_dim;
}

/* ---- The voxels of the model ---- */

static vxm_status fill_set(labels *l, const vxm_field_plan *plan, vxm_sum *sum, vxm_error *error) {
  vxm_status status = vxm_model_begin(l->model, l->space, NULL, NULL, error);
  vxm_window part = l->set;
  for (int64_t begin = 0; begin < l->set.slow_dim && status == VXM_OK; begin = part.end) {
    part.begin = begin;
    part.end = vxm_min(begin + plan->slices, l->set.slow_dim);
    part.words = l->set.words + (size_t)begin * l->set.slice_words;
    status = vxm_model_fill(l->model, &part, error);
  }
  *sum = vxm_sum_start(l->space);
  if (status == VXM_OK)
    vxm_sum_add(sum, l->context, &l->set, NULL);
  return status;
}

static void clear_tile(size_t task, int worker, void *payload) {
  (void)worker;
  const labels *l = payload;
  tile t = tile_at(l, task);
  for (int64_t slow = t.begin[1]; slow < t.end[1]; slow++)
    memset(value_row(l, t.begin[0], slow), 0,
           (size_t)((t.end[0] - t.begin[0]) * l->set.fast_dim) * sizeof *l->values);
}

/* ---- The solids of pieces ---- */

static vxm_window box_window(const labels *l, const vxm_piece *piece) {
  vxm_space space = vxm_piece_space(piece, l->space);
  return vxm_window_of(&space, l->set.layout, 0, space.dims[l->set.layout.slow]);
}

static size_t box_words(const labels *l, const vxm_piece *piece) {
  vxm_window window = box_window(l, piece);
  return window.slice_words * (size_t)window.slow_dim;
}

static bool is_small(const labels *l, const vxm_piece *piece) {
  return piece->face_end - piece->first_face <= SMALL_FACES && box_words(l, piece) <= SMALL_WORDS;
}

/** Lists the solids of pieces from `first` on, and where they go; returns the first piece that is not listed.
 */
static size_t list_batch(labels *l, size_t first) {
  const vxm_layout *layout = &l->set.layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  size_t used = 0, p = first;
  l->batch = 0;
  for (; p < l->pieces.count && l->batch < BATCH; p++) {
    const vxm_piece *piece = &l->pieces.pieces[p];
    size_t words = box_words(l, piece);
    bool small = is_small(l, piece);
    if (words == 0)
      continue;
    if (l->batch > 0 && (!small || used + words > BATCH_WORDS))
      break;
    solid *s = &l->solids[l->batch++];
    s->piece = piece;
    s->window = box_window(l, piece);
    s->window.words = l->words + used;
    for (int a = 0; a < 3; a++)
      s->first[a] = piece->begin[axis[a]];
    atomic_store_explicit(&s->is_contested, false, memory_order_relaxed);
    used += words;
    if (!small)
      return p + 1;
  }
  return p;
}

/** Words of the largest batch. */
static size_t words_needed(const labels *l) {
  size_t most = 0, small = 0;
  for (size_t p = 0; p < l->pieces.count; p++) {
    size_t words = box_words(l, &l->pieces.pieces[p]);
    most = words > most ? words : most;
    small += words <= SMALL_WORDS ? words : 0;
  }
  small = small < BATCH_WORDS ? small : BATCH_WORDS;
  return most > small ? most : small;
}

static void make_solid(size_t task, int worker, void *payload) {
  labels *l = payload;
  solid *s = &l->solids[task];
  if (atomic_load_explicit(&l->has_failed, memory_order_relaxed))
    return;
  vxm_status status = vxm_piece_fill(&l->desks[worker], &s->window, &l->pieces, s->piece, &l->model->options,
                                     &l->lattice, l->batch > 1, &l->errors[worker]);
  if (status != VXM_OK)
    atomic_store_explicit(&l->has_failed, true, memory_order_relaxed);
}

/** One piece is made by all threads; of many each by one, as the loops inside are too short for several. */
static vxm_status make_solids(labels *l, vxm_error *error) {
  if (l->batch == 1)
    make_solid(0, 0, l);
  else
    vxm_parallel(l->context, l->batch, make_solid, l);
  if (!atomic_load_explicit(&l->has_failed, memory_order_relaxed))
    return VXM_OK;
  int worker = 0;
  while (l->errors[worker].code == VXM_OK)
    worker++;
  if (error)
    *error = l->errors[worker];
  return l->errors[worker].code;
}

/* ---- Claims ---- */

/** A label takes the set voxels of a row of its solid that have none; what is left of the solid are those
 * that have another. Returns whether there are such. */
static bool claim_row(const labels *l, const solid *s, int64_t middle, int64_t slow) {
  uint16_t label = (uint16_t)s->piece->label;
  uint16_t *values = value_row(l, middle + s->first[1], slow + s->first[2]) + s->first[0];
  uint64_t *claims = vxm_window_row(&s->window, middle, slow), any = 0;
  size_t place = (size_t)(vxm_window_row(&l->set, middle + s->first[1], slow + s->first[2]) - l->set.words) +
                 (size_t)s->first[0] / 64;
  for (size_t w = 0; w < s->window.row_words; w++) {
    uint64_t left = 0;
    for (uint64_t bits = claims[w] & l->set.words[place + w]; bits; bits &= bits - 1) {
      uint16_t *value = &values[64 * w + (size_t)__builtin_ctzll(bits)];
      *value = *value ? *value : label;
      left |= *value != label ? bits & -bits : 0;
    }
    claims[w] = left;
    l->several[place + w] |= left;
    any |= left;
  }
  return any != 0;
}

static void claim_tile(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  tile t = tile_at(l, task), part;
  for (size_t i = 0; i < l->batch; i++) {
    solid *s = &l->solids[i];
    if (!part_of(&part, &t, s))
      continue;
    bool is_contested = false;
    for (int64_t slow = part.begin[1]; slow < part.end[1]; slow++)
      for (int64_t middle = part.begin[0]; middle < part.end[0]; middle++)
        is_contested |= claim_row(l, s, middle, slow);
    if (is_contested)
      atomic_store_explicit(&s->is_contested, true, memory_order_relaxed);
  }
}

/** Contested voxels go to the nearer of two labels, solid after solid. */
static void settle_tile(size_t task, int worker, void *payload) {
  labels *l = payload;
  tile t = tile_at(l, task), part;
  if (vxm_watch_stopped(&l->watch, worker))
    return;
  for (size_t i = 0; i < l->batch; i++) {
    const solid *s = &l->solids[i];
    if (!atomic_load_explicit(&s->is_contested, memory_order_relaxed) || !part_of(&part, &t, s))
      continue;
    vxm_award award = {l->forest, l->space, &s->window, s->first, l->values, s->piece->label};
    const int64_t begin[3] = {0, part.begin[0], part.begin[1]},
                  end[3] = {s->window.fast_dim, part.end[0], part.end[1]};
    vxm_award_voxels(&award, begin, end);
  }
  vxm_watch_step(&l->watch);
}

static vxm_status settle_tiles(labels *l, vxm_task_fn function, vxm_error *error) {
  vxm_status status = l->forest ? VXM_OK : vxm_forest_create(&l->forest, l->labelling, l->space, error);
  if (status != VXM_OK)
    return status;
  vxm_watch_start(&l->watch, l->context, "labelling", tile_count(l), error);
  vxm_parallel(l->context, tile_count(l), function, l);
  return vxm_watch_end(&l->watch);
}

static vxm_status claim_batch(labels *l, vxm_error *error) {
  bool is_contested = false;
  l->begin[0] = l->begin[1] = INT64_MAX;
  l->end[0] = l->end[1] = 0;
  for (size_t i = 0; i < l->batch; i++) {
    const solid *s = &l->solids[i];
    const int64_t dims[2] = {s->window.middle_dim, s->window.slow_dim};
    for (int a = 0; a < 2; a++) {
      l->begin[a] = vxm_min(l->begin[a], s->first[a + 1]);
      l->end[a] = vxm_max(l->end[a], s->first[a + 1] + dims[a]);
    }
  }
  vxm_parallel(l->context, tile_count(l), claim_tile, l);
  for (size_t i = 0; i < l->batch; i++)
    is_contested |= atomic_load_explicit(&l->solids[i].is_contested, memory_order_relaxed);
  return is_contested ? settle_tiles(l, settle_tile, error) : VXM_OK;
}

static vxm_status claim_all(labels *l, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t p = 0; p < l->pieces.count && status == VXM_OK;) {
    p = list_batch(l, p);
    if (l->batch == 0)
      break;
    status = make_solids(l, error);
    if (status == VXM_OK)
      status = claim_batch(l, error);
    if (status == VXM_OK)
      status = vxm_progress(l->context, "labelling", (double)p / (double)l->pieces.count, error);
  }
  return status;
}

/* ---- What no label claims ---- */

/** Leaves of the set voxels those without a label. */
static void leave_tile(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  tile t = tile_at(l, task);
  int64_t left = 0;
  for (int64_t slow = t.begin[1]; slow < t.end[1]; slow++)
    for (int64_t middle = t.begin[0]; middle < t.end[0]; middle++) {
      const uint16_t *values = value_row(l, middle, slow);
      uint64_t *words = vxm_window_row(&l->set, middle, slow);
      for (size_t w = 0; w < l->set.row_words; w++) {
        for (uint64_t bits = words[w]; bits; bits &= bits - 1)
          words[w] ^= values[64 * w + (size_t)__builtin_ctzll(bits)] ? bits & -bits : 0;
        left += vxm_popcount(words[w]);
      }
    }
  atomic_fetch_add_explicit(&l->unclaimed, left, memory_order_relaxed);
}

static void settle_left_tile(size_t task, int worker, void *payload) {
  static const int64_t nowhere[3] = {0, 0, 0};
  labels *l = payload;
  if (vxm_watch_stopped(&l->watch, worker))
    return;
  tile t = tile_at(l, task);
  vxm_award award = {l->forest, l->space, &l->set, nowhere, l->values, 0};
  const int64_t begin[3] = {0, t.begin[0], t.begin[1]}, end[3] = {l->set.fast_dim, t.end[0], t.end[1]};
  vxm_award_voxels(&award, begin, end);
  vxm_watch_step(&l->watch);
}

static vxm_status settle_unclaimed(labels *l, vxm_error *error) {
  tile_all(l);
  vxm_parallel(l->context, tile_count(l), leave_tile, l);
  if (atomic_load_explicit(&l->unclaimed, memory_order_relaxed) == 0)
    return VXM_OK;
  return settle_tiles(l, settle_left_tile, error);
}

/* ---- Counts ---- */

static void count_tile(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  tile t = tile_at(l, task);
  for (int64_t slow = t.begin[1]; slow < t.end[1]; slow++) {
    const uint16_t *at = value_row(l, t.begin[0], slow), *last = value_row(l, t.end[0], slow);
    while (at < last) {
      const uint16_t *run = at++;
      while (at < last && *at == *run)
        at++;
      if (*run)
        atomic_fetch_add_explicit(&l->counts[*run - 1], at - run, memory_order_relaxed);
    }
  }
}

static void sum_up(labels *l, vxm_label_report *report, const vxm_sum *sum) {
  vxm_label_table *table = &l->labelling->table;
  vxm_notes *notes = &l->model->notes;
  size_t empty = 0, first = 0;
  vxm_parallel(l->context, tile_count(l), count_tile, l);
  for (size_t label = table->count; label > 0; label--) {
    table->voxels[label - 1] = atomic_load_explicit(&l->counts[label - 1], memory_order_relaxed);
    empty += table->voxels[label - 1] == 0;
    first = table->voxels[label - 1] == 0 ? label : first;
  }
  *report = (vxm_label_report){.labels = (int64_t)table->count};
  report->unclaimed = atomic_load_explicit(&l->unclaimed, memory_order_relaxed);
  for (size_t w = 0; w < grid_words(l); w++)
    report->contested += vxm_popcount(l->several[w]);
  vxm_model_end(l->model, &report->voxelize, sum->count, sum->hash);
  if (l->labelling->is_untagged)
    vxm_note(notes, "the mesh names no groups or materials: all of it has one label, \"unnamed\"");
  if (empty > 0 && sum->count > 0)
    vxm_note(notes, "%zu of %zu labels have no voxel, the first of them label %zu, \"%.80s\"", empty,
             table->count, first, vxm_label_table_name(table, first));
}

/* ---- All of it ---- */

/** What is held beside the values and the model's own scratch. */
static uint64_t fixed_bytes(const labels *l) {
  const vxm_labelling *labelling = l->labelling;
  uint64_t most = 0;
  for (size_t p = 0; p < l->pieces.count; p++) {
    uint64_t bytes = vxm_piece_bytes(&l->pieces, &l->pieces.pieces[p]);
    most = bytes > most ? bytes : most;
  }
  return (2 * (uint64_t)grid_words(l) + words_needed(l)) * sizeof(uint64_t) + most +
         vxm_forest_bytes(labelling) + labelling->table.count * sizeof *l->counts;
}

static vxm_status allocate(labels *l, vxm_error *error) {
  size_t threads = (size_t)vxm_context_threads(l->context);
  vxm_error local = VXM_ERROR_INIT;
  l->set.words = vxm_alloc(l->context, grid_words(l), sizeof *l->set.words, &local);
  l->several = vxm_calloc(l->context, grid_words(l), sizeof *l->several, &local);
  l->words = vxm_alloc(l->context, words_needed(l), sizeof *l->words, &local);
  l->counts = vxm_calloc(l->context, l->labelling->table.count, sizeof *l->counts, &local);
  l->errors = vxm_calloc(l->context, threads, sizeof *l->errors, &local);
  l->desks = vxm_calloc(l->context, threads, sizeof *l->desks, &local);
  if (local.code != VXM_OK && error)
    *error = local;
  return local.code;
}

static void destroy(labels *l) {
  for (int w = 0; l->desks && w < vxm_context_threads(l->context); w++)
    vxm_piece_desk_destroy(&l->desks[w], l->context);
  vxm_free(l->context, l->desks);
  vxm_free(l->context, l->errors);
  vxm_free(l->context, l->counts);
  vxm_free(l->context, l->words);
  vxm_free(l->context, l->several);
  vxm_free(l->context, l->set.words);
  vxm_forest_destroy(l->forest);
  vxm_pieces_destroy(&l->pieces);
}

static vxm_status run(labels *l, vxm_label_report *report, vxm_error *error) {
  vxm_layout layout = l->set.layout;
  vxm_field_plan plan;
  vxm_sum sum;
  vxm_status status =
      vxm_pieces_create(&l->pieces, l->labelling, &l->model->options, &l->lattice, layout.fast, error);
  if (status == VXM_OK)
    status = vxm_field_plan_of(&plan, l->model, l->space, layout, 1, fixed_bytes(l), 0, error);
  if (status == VXM_OK)
    status = allocate(l, error);
  if (status == VXM_OK)
    status = fill_set(l, &plan, &sum, error);
  if (status == VXM_OK) {
    tile_all(l);
    vxm_parallel(l->context, tile_count(l), clear_tile, l);
    status = claim_all(l, error);
  }
  if (status == VXM_OK)
    status = settle_unclaimed(l, error);
  if (status == VXM_OK)
    sum_up(l, report, &sum);
  return status;
}

vxm_status vxm_labels_run(uint16_t *values, vxm_layout layout, vxm_label_report *report, vxm_model *model,
                          const vxm_space *space, vxm_labelling *labelling, vxm_error *error) {
  vxm_context *context = model->context;
  vxm_error local = VXM_ERROR_INIT;
  vxm_label_table_destroy(&model->labels);
  labels *l = vxm_calloc(context, 1, sizeof *l, &local);
  vxm_status status = local.code;
  if (l) {
    l->context = context;
    l->model = model;
    l->space = space;
    l->lattice = vxm_lattice_of(space);
    l->labelling = labelling;
    l->values = values;
    l->set = vxm_window_of(space, layout, 0, space->dims[layout.slow]);
    l->pieces.context = context;
    status = run(l, report, &local);
    destroy(l);
    vxm_free(context, l);
  }
  if (status != VXM_OK) {
    if (error)
      *error = local;
    return status;
  }
  model->labels = labelling->table;
  labelling->table = (vxm_label_table){.context = context};
  return VXM_OK;
}
