/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/labels.h"
#include "base/threads.h"
#include "grid/sum.h"
#include "voxel/award.h"
#include "voxel/field.h"

#include <stdatomic.h>
#include <string.h>

enum { ROWS_PER_TASK = 64 };

typedef struct labels {
  vxm_context *context;
  vxm_model *model;
  const vxm_space *space;
  vxm_lattice lattice;
  vxm_labelling *labelling;
  uint16_t *values;
  vxm_window set;     /**< the voxels of the model; in the end those without a label */
  uint64_t *several;  /**< voxels that more than one label claims; NULL = none so far */
  vxm_forest *forest; /**< NULL = not needed so far */
  /* Of the label at hand: */
  uint32_t label;
  vxm_soup *soup;
  uint32_t *local;  /**< per vertex of the mesh: where it may be in `soup` */
  uint32_t *vertex; /**< per vertex of `soup` */
  int64_t first[3]; /**< voxel at which its box begins, in the order of the layout */
  vxm_window solid; /**< of the box */
  atomic_bool is_contested;
  atomic_int_fast64_t unclaimed; /**< set voxels that no label claims */
  atomic_int_fast64_t *counts;   /**< of each label, the voxels that have it */
} labels;

/* ---- Rows ---- */

static size_t tasks_of(const vxm_window *window) {
  size_t rows = (size_t)((window->end - window->begin) * window->middle_dim);
  return (rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
}

/** The rows of a task: first..end-1, counted through the slices of a window. */
static int64_t rows_of(size_t task, const vxm_window *window, int64_t *first) {
  *first = (int64_t)task * ROWS_PER_TASK;
  return vxm_min(*first + ROWS_PER_TASK, (window->end - window->begin) * window->middle_dim);
}

static void clear_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const labels *l = payload;
  int64_t row, end = rows_of(task, &l->set, &row), length = l->set.fast_dim;
  memset(l->values + row * length, 0, (size_t)((end - row) * length) * sizeof *l->values);
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

/* ---- The faces of a label as a soup of their own ---- */

static vxm_status add_vertex(labels *l, uint32_t vertex, uint32_t *out, vxm_error *error) {
  uint32_t at = l->local[vertex];
  vxm_status status = VXM_OK;
  if (at >= l->soup->vertex_count || l->vertex[at] != vertex) {
    const double *p = vxm_position(l->labelling->soup, vertex);
    at = l->local[vertex] = (uint32_t)l->soup->vertex_count;
    l->vertex[at] = vertex;
    status = vxm_soup_add_vertex(l->soup, p[0], p[1], p[2], error);
  }
  *out = at;
  return status;
}

static vxm_status gather_faces(labels *l, vxm_error *error) {
  const vxm_labelling *from = l->labelling;
  vxm_soup *soup = l->soup;
  soup->vertex_count = soup->face_count = soup->corner_count = 0;
  vxm_status status = VXM_OK;
  for (size_t i = from->begin[l->label - 1]; i < from->begin[l->label] && status == VXM_OK; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(from->soup, from->faces[i], &n);
    status = vxm_soup_reserve(soup, 0, soup->face_count + 1, soup->corner_count + n, error);
    for (size_t c = 0; c < n && status == VXM_OK; c++)
      status = add_vertex(l, corner[c], &soup->indices[soup->corner_count + c], error);
    soup->corner_count += n;
    soup->offsets[++soup->face_count] = soup->corner_count;
  }
  return status;
}

/* ---- Boxes ---- */

/** The voxels that a label may claim: begin..end-1 along each axis of the space. */
typedef struct box {
  int64_t begin[3], end[3];
} box;

static void add_to_box(box *b, const vxm_lattice *lattice, const double p[3]) {
  vxm_point point;
  if (!vxm_lattice_place(lattice, p, &point))
    return;
  for (int a = 0; a < 3; a++) {
    b->begin[a] = vxm_min(b->begin[a], vxm_lattice_first(lattice, point.at[a]) - 1);
    b->end[a] = vxm_max(b->end[a], vxm_lattice_last(lattice, point.at[a]) + 2);
  }
}

/** The box of the voxels whose centres lie within the bounds of a label, with one more on all sides; along
 * rows it begins with a word. */
static bool box_of(box *out, const labels *l, size_t label) {
  const vxm_labelling *from = l->labelling;
  bool is_empty = false;
  *out = (box){{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
  for (size_t i = from->begin[label - 1]; i < from->begin[label]; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(from->soup, from->faces[i], &n);
    for (size_t c = 0; c < n; c++)
      add_to_box(out, &l->lattice, vxm_position(from->soup, corner[c]));
  }
  for (int a = 0; a < 3; a++) {
    out->begin[a] = vxm_max(out->begin[a], 0);
    out->end[a] = vxm_min(out->end[a], l->space->dims[a]);
    is_empty = is_empty || out->begin[a] >= out->end[a];
  }
  int fast = l->set.layout.fast;
  out->begin[fast] -= is_empty ? 0 : out->begin[fast] % 64;
  return !is_empty;
}

static vxm_space space_of(const labels *l, const box *b) {
  vxm_space space = *l->space;
  for (int a = 0; a < 3; a++) {
    space.origin[a] += (double)b->begin[a] * space.voxel_size[a];
    space.dims[a] = b->end[a] - b->begin[a];
  }
  return space;
}

/** Words of the largest box. */
static uint64_t largest_box(const labels *l) {
  uint64_t most = 0;
  for (size_t label = 1; label <= l->labelling->table.count; label++) {
    box b;
    if (!box_of(&b, l, label))
      continue;
    vxm_space space = space_of(l, &b);
    vxm_window window = vxm_window_of(&space, l->set.layout, 0, 0);
    uint64_t words = window.slice_words * (uint64_t)window.slow_dim;
    most = words > most ? words : most;
  }
  return most;
}

/* ---- Claims ---- */

/** The label takes set voxels of its solid that have none; what is left of the solid are those that have. */
static void claim_rows(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  const vxm_window *solid = &l->solid;
  uint64_t contested = 0;
  int64_t row, end = rows_of(task, solid, &row);
  for (; row < end; row++) {
    int64_t middle = row % solid->middle_dim + l->first[1], slow = row / solid->middle_dim + l->first[2];
    uint64_t *claims = solid->words + (size_t)row * solid->row_words;
    const uint64_t *set = vxm_window_row(&l->set, middle, slow) + l->first[0] / 64;
    uint16_t *values = l->values + (slow * l->set.middle_dim + middle) * l->set.fast_dim + l->first[0];
    for (size_t w = 0; w < solid->row_words; w++) {
      uint64_t left = 0;
      for (uint64_t bits = claims[w] & set[w]; bits; bits &= bits - 1) {
        uint16_t *value = &values[64 * w + (size_t)__builtin_ctzll(bits)];
        left |= *value ? bits & -bits : 0;
        *value = *value ? *value : (uint16_t)l->label;
      }
      claims[w] = left;
      contested |= left;
    }
  }
  if (contested)
    atomic_store_explicit(&l->is_contested, true, memory_order_relaxed);
}

/** Marks what is contested as claimed by several. */
static void mark_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const labels *l = payload;
  int64_t row, end = rows_of(task, &l->solid, &row);
  for (; row < end; row++) {
    int64_t middle = row % l->solid.middle_dim + l->first[1], slow = row / l->solid.middle_dim + l->first[2];
    uint64_t *several =
        l->several + (size_t)(slow * l->set.middle_dim + middle) * l->set.row_words + l->first[0] / 64;
    for (size_t w = 0; w < l->solid.row_words; w++)
      several[w] |= l->solid.words[(size_t)row * l->solid.row_words + w];
  }
}

static vxm_status need_forest(labels *l, vxm_error *error) {
  return l->forest ? VXM_OK : vxm_forest_create(&l->forest, l->labelling, l->space, error);
}

static vxm_status settle_contested(labels *l, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  if (!l->several)
    l->several =
        vxm_calloc(l->context, l->set.slice_words * (size_t)l->set.slow_dim, sizeof *l->several, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = need_forest(l, &local);
  if (status != VXM_OK) {
    if (error)
      *error = local;
    return status;
  }
  vxm_parallel(l->context, tasks_of(&l->solid), mark_rows, l);
  vxm_award award = {l->forest, l->space, &l->solid, {l->first[0], l->first[1], l->first[2]},
                     l->values, l->label};
  return vxm_award_voxels(&award, l->context, error);
}

/** Fills the box with the label's own solid. */
static vxm_status fill_solid(labels *l, vxm_model *own, const vxm_space *space, vxm_error *error) {
  vxm_lattice lattice = l->lattice;
  lattice.space = *space;
  vxm_field_plan plan;
  vxm_status status = vxm_field_plan_of(&plan, own, space, l->set.layout, 1, 0, 0, error);
  if (status == VXM_OK)
    status = vxm_model_begin_on(own, &lattice, NULL, NULL, error);
  vxm_window part = l->solid;
  for (int64_t begin = 0; begin < l->solid.slow_dim && status == VXM_OK; begin = part.end) {
    part.begin = begin;
    part.end = vxm_min(begin + plan.slices, l->solid.slow_dim);
    part.words = l->solid.words + (size_t)begin * l->solid.slice_words;
    status = vxm_model_fill(own, &part, error);
  }
  return status;
}

static vxm_status claim(labels *l, vxm_error *error) {
  box b;
  if (!box_of(&b, l, l->label))
    return VXM_OK;
  vxm_space space = space_of(l, &b);
  const vxm_layout *layout = &l->set.layout;
  const int axis[3] = {layout->fast, layout->middle, layout->slow};
  for (int a = 0; a < 3; a++)
    l->first[a] = b.begin[axis[a]];
  uint64_t *words = l->solid.words;
  l->solid = vxm_window_of(&space, *layout, 0, space.dims[layout->slow]);
  l->solid.words = words;
  vxm_voxelize_options options = l->model->options;
  options.mode = VXM_MODE_SOLID;
  options.confidence = false;
  vxm_model *own = NULL;
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = gather_faces(l, &local);
  if (status == VXM_OK)
    status = vxm_model_make(&own, l->soup, &options, &local);
  if (status == VXM_ERROR_EMPTY) /* faces without area claim nothing */
    return VXM_OK;
  if (status == VXM_OK)
    status = fill_solid(l, own, &space, &local);
  vxm_model_destroy(own);
  if (status != VXM_OK) {
    if (error)
      *error = local;
    return status;
  }
  atomic_store_explicit(&l->is_contested, false, memory_order_relaxed);
  vxm_parallel(l->context, tasks_of(&l->solid), claim_rows, l);
  return atomic_load_explicit(&l->is_contested, memory_order_relaxed) ? settle_contested(l, error) : VXM_OK;
}

static vxm_status claim_all(labels *l, vxm_error *error) {
  size_t count = l->labelling->table.count;
  vxm_status status = VXM_OK;
  for (size_t label = 1; label <= count && status == VXM_OK; label++) {
    l->label = (uint32_t)label;
    status = claim(l, error);
    if (status == VXM_OK)
      status = vxm_progress(l->context, "labelling", (double)label / (double)count, error);
  }
  return status;
}

/* ---- What no label claims ---- */

/** Leaves of the set voxels those without a label. */
static void leave_rows(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  int64_t row, end = rows_of(task, &l->set, &row), left = 0;
  for (; row < end; row++) {
    const uint16_t *values = l->values + row * l->set.fast_dim;
    uint64_t *words = l->set.words + (size_t)row * l->set.row_words;
    for (size_t w = 0; w < l->set.row_words; w++) {
      for (uint64_t bits = words[w]; bits; bits &= bits - 1)
        if (values[64 * w + (size_t)__builtin_ctzll(bits)])
          words[w] ^= bits & -bits;
      left += vxm_popcount(words[w]);
    }
  }
  atomic_fetch_add_explicit(&l->unclaimed, left, memory_order_relaxed);
}

static vxm_status settle_unclaimed(labels *l, vxm_error *error) {
  vxm_parallel(l->context, tasks_of(&l->set), leave_rows, l);
  if (atomic_load_explicit(&l->unclaimed, memory_order_relaxed) == 0)
    return VXM_OK;
  vxm_status status = need_forest(l, error);
  if (status != VXM_OK)
    return status;
  vxm_award award = {l->forest, l->space, &l->set, {0, 0, 0}, l->values, 0};
  return vxm_award_voxels(&award, l->context, error);
}

/* ---- Counts ---- */

static void count_rows(size_t task, int worker, void *payload) {
  (void)worker;
  labels *l = payload;
  int64_t row, end = rows_of(task, &l->set, &row), length = l->set.fast_dim;
  const uint16_t *at = l->values + row * length, *last = l->values + end * length;
  while (at < last) {
    const uint16_t *run = at++;
    while (at < last && *at == *run)
      at++;
    if (*run)
      atomic_fetch_add_explicit(&l->counts[*run - 1], at - run, memory_order_relaxed);
  }
}

static void sum_up(labels *l, vxm_label_report *report, const vxm_sum *sum) {
  vxm_label_table *table = &l->labelling->table;
  vxm_notes *notes = &l->model->notes;
  size_t words = l->set.slice_words * (size_t)l->set.slow_dim, empty = 0, first = 0;
  vxm_parallel(l->context, tasks_of(&l->set), count_rows, l);
  for (size_t label = table->count; label > 0; label--) {
    table->voxels[label - 1] = atomic_load_explicit(&l->counts[label - 1], memory_order_relaxed);
    empty += table->voxels[label - 1] == 0;
    first = table->voxels[label - 1] == 0 ? label : first;
  }
  *report = (vxm_label_report){.labels = (int64_t)table->count};
  report->unclaimed = atomic_load_explicit(&l->unclaimed, memory_order_relaxed);
  for (size_t w = 0; w < words && l->several; w++)
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
static uint64_t fixed_bytes(const labels *l, uint64_t box_words) {
  enum { MODEL_BYTES = 256 /* of a model, for each corner of a face */ };
  const vxm_labelling *from = l->labelling;
  uint64_t grid = l->set.slice_words * (uint64_t)l->set.slow_dim, most = 0;
  for (size_t label = 1; label <= from->table.count; label++) {
    uint64_t corners = 0;
    for (size_t i = from->begin[label - 1]; i < from->begin[label]; i++) {
      size_t n;
      vxm_face(from->soup, from->faces[i], &n);
      corners += n;
    }
    most = corners > most ? corners : most;
  }
  return (2 * grid + box_words) * sizeof(uint64_t) + most * MODEL_BYTES + vxm_forest_bytes(from) +
         2 * from->soup->vertex_count * sizeof(uint32_t) + from->table.count * sizeof *l->counts;
}

static vxm_status allocate(labels *l, uint64_t box_words, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t vertices = l->labelling->soup->vertex_count, grid = l->set.slice_words * (size_t)l->set.slow_dim;
  l->set.words = vxm_alloc(l->context, grid, sizeof *l->set.words, &local);
  l->solid.words = vxm_alloc(l->context, box_words, sizeof *l->solid.words, &local);
  l->local = vxm_calloc(l->context, vertices, sizeof *l->local, &local);
  l->vertex = vxm_alloc(l->context, vertices, sizeof *l->vertex, &local);
  l->counts = vxm_calloc(l->context, l->labelling->table.count, sizeof *l->counts, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_soup_create(&l->soup, l->context, "label", &local);
  if (status != VXM_OK && error)
    *error = local;
  return status;
}

static void destroy(labels *l) {
  vxm_forest_destroy(l->forest);
  vxm_soup_destroy(l->soup);
  vxm_free(l->context, l->several);
  vxm_free(l->context, l->counts);
  vxm_free(l->context, l->vertex);
  vxm_free(l->context, l->local);
  vxm_free(l->context, l->solid.words);
  vxm_free(l->context, l->set.words);
}

vxm_status vxm_labels_run(uint16_t *values, vxm_layout layout, vxm_label_report *report, vxm_model *model,
                          const vxm_space *space, vxm_labelling *labelling, vxm_error *error) {
  labels l = {.context = model->context,
              .model = model,
              .space = space,
              .lattice = vxm_lattice_of(space),
              .labelling = labelling,
              .values = values,
              .set = vxm_window_of(space, layout, 0, space->dims[layout.slow])};
  vxm_label_table_destroy(&model->labels);
  uint64_t box_words = largest_box(&l);
  vxm_field_plan plan;
  vxm_sum sum;
  vxm_status status = vxm_field_plan_of(&plan, model, space, layout, 1, fixed_bytes(&l, box_words), 0, error);
  if (status == VXM_OK)
    status = allocate(&l, box_words, error);
  if (status == VXM_OK)
    status = fill_set(&l, &plan, &sum, error);
  if (status == VXM_OK) {
    vxm_parallel(l.context, tasks_of(&l.set), clear_rows, &l);
    status = claim_all(&l, error);
  }
  if (status == VXM_OK)
    status = settle_unclaimed(&l, error);
  if (status == VXM_OK) {
    sum_up(&l, report, &sum);
    model->labels = labelling->table;
    labelling->table = (vxm_label_table){.context = l.context};
  }
  destroy(&l);
  return status;
}
