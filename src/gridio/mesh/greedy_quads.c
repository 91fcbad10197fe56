/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/mesh/greedy_quads.h"
#include "base/threads.h"
#include "grid/bit_transpose.h"

#include <string.h>

/* Layers of a y or z task; an x task has the 64 layers of a word column. */
enum { LAYERS = 16, RECTANGLES_MAX = 1 << 30 };

/** What a task works on. A failed task leaves its status and stops; the first in order is reported. */
typedef struct task_state {
  vxm_greedy_quad_list *list;
  vxm_context *context;
  vxm_status status;
  vxm_error error;
} task_state;

/* ---- Greedy merging of the set bits of one layer ---- */

/** First clear bit of a row from `begin` on, at most words * 64. */
static size_t run_end(const uint64_t *row, size_t begin, size_t words) {
  size_t w = begin / 64;
  uint64_t clear = ~row[w] & ~UINT64_C(0) << (begin % 64);
  while (!clear && ++w < words)
    clear = ~row[w];
  return clear ? w * 64 + (size_t)__builtin_ctzll(clear) : words * 64;
}

/** The bits begin..end-1 that fall into word w. */
static uint64_t span_mask(size_t begin, size_t end, size_t w) {
  uint64_t mask = ~UINT64_C(0);
  if (w == begin / 64)
    mask <<= begin % 64;
  if (w == (end - 1) / 64)
    mask &= vxm_low_bits((unsigned)((end - 1) % 64) + 1);
  return mask;
}

/** Clears the span if all of it is set; otherwise leaves the row alone and returns false. */
static bool take_span(uint64_t *row, size_t begin, size_t end) {
  for (size_t w = begin / 64; w <= (end - 1) / 64; w++)
    if (~row[w] & span_mask(begin, end, w))
      return false;
  for (size_t w = begin / 64; w <= (end - 1) / 64; w++)
    row[w] &= ~span_mask(begin, end, w);
  return true;
}

static void add(task_state *task, vxm_greedy_quad rectangle) {
  vxm_greedy_quad_list *list = task->list;
  if (task->status == VXM_OK && list->count == list->capacity)
    task->status = vxm_grow(task->context, (void **)&list->items, &list->capacity, list->count + 1,
                            sizeof *list->items, &task->error);
  if (task->status == VXM_OK)
    list->items[list->count++] = rectangle;
}

/** Takes the longest run along u, then as many rows along v as have all of it; clears the layer on the way.
 */
static void merge_layer(task_state *task, uint64_t *layer, size_t rows, size_t words, uint32_t level) {
  for (size_t v = 0; v < rows && task->status == VXM_OK; v++) {
    uint64_t *row = layer + v * words;
    for (size_t w = 0; w < words; w++)
      while (row[w] && task->status == VXM_OK) {
        size_t u0 = w * 64 + (size_t)__builtin_ctzll(row[w]), u1 = run_end(row, u0, words), v1 = v;
        while (v1 < rows && take_span(layer + v1 * words, u0, u1))
          v1++;
        add(task, (vxm_greedy_quad){level, (uint32_t)u0, (uint32_t)v, (uint32_t)u1, (uint32_t)v1});
      }
  }
}

/* ---- The exposed faces of a layer ---- */

static uint64_t exposed_low_x(const uint64_t *row, size_t w, size_t words) {
  (void)words;
  return row[w] & ~(row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 0));
}

static uint64_t exposed_high_x(const uint64_t *row, size_t w, size_t words) {
  return row[w] & ~(row[w] >> 1 | (w + 1 < words ? row[w + 1] << 63 : 0));
}

/** Across x the layers of a word column are planes, made from the words of exposed faces. */
static void merge_x(task_state *task, const vxm_grid *grid, size_t word) {
  vxm_bit_transpose planes;
  task->status = vxm_bit_transpose_create(&planes, grid->context, &grid->space, (vxm_layout)VXM_PLANE_Y_FAST,
                                          &task->error);
  if (task->status != VXM_OK)
    return;
  for (uint32_t side = 0; side < 2; side++) {
    vxm_bit_transpose_gather(&planes, grid, word, side ? exposed_high_x : exposed_low_x);
    for (size_t p = 0; p < vxm_bit_transpose_in(grid, word); p++)
      merge_layer(task, vxm_plane_row(&planes, p, 0), planes.rows, planes.row_words,
                  2 * ((uint32_t)(word * 64 + p) + side) + side);
  }
  vxm_bit_transpose_destroy(&planes);
}

/** Sets one row of a layer to what `row` has and `beside` (NULL = outside the grid) has not. */
static uint64_t expose_row(uint64_t *to, const uint64_t *row, const uint64_t *beside, size_t words) {
  uint64_t any = 0;
  for (size_t w = 0; w < words; w++)
    any |= to[w] = beside ? row[w] & ~beside[w] : row[w];
  return any;
}

/** Across y (axis 1) and z (axis 2) the rows of the grid are the rows of a layer. */
static void merge_yz(task_state *task, const vxm_grid *grid, size_t chunk) {
  int axis = task->list->axis;
  size_t words = grid->row_words, layers = (size_t)grid->space.dims[axis];
  size_t rows = (size_t)grid->space.dims[3 - axis];
  size_t layer_step = axis == 1 ? words : grid->slice_words, row_step = axis == 1 ? grid->slice_words : words;
  uint64_t *layer = vxm_alloc(grid->context, rows * words, sizeof *layer, &task->error);
  if (!layer) {
    task->status = task->error.code;
    return;
  }
  size_t end = (chunk + 1) * LAYERS < layers ? (chunk + 1) * LAYERS : layers;
  for (size_t l = chunk * LAYERS; l < end; l++)
    for (uint32_t side = 0; side < 2; side++) {
      bool at_border = side ? l + 1 == layers : l == 0;
      uint64_t any = 0;
      for (size_t r = 0; r < rows; r++) {
        const uint64_t *row = grid->words + l * layer_step + r * row_step;
        const uint64_t *beside = at_border ? NULL : side ? row + layer_step : row - layer_step;
        any |= expose_row(layer + r * words, row, beside, words);
      }
      if (any)
        merge_layer(task, layer, rows, words, 2 * ((uint32_t)l + side) + side);
    }
  vxm_free(grid->context, layer);
}

/* ---- All layers ---- */

typedef struct search {
  const vxm_grid *grid;
  task_state *tasks; /**< of this step */
  size_t first;      /**< chunk of the first */
} search;

static void run_task(size_t index, int worker, void *payload) {
  (void)worker;
  const search *s = payload;
  task_state *task = &s->tasks[index];
  if (task->list->axis == 0)
    merge_x(task, s->grid, s->first + index);
  else
    merge_yz(task, s->grid, s->first + index);
}

/** Chunks of one axis, a few at a time so that the work can be stopped. */
static vxm_status find_axis(vxm_greedy_quads *all, const vxm_grid *grid, vxm_greedy_quad_list *lists,
                            size_t chunks, int axis, vxm_error *error) {
  enum { STEP = 32 };
  task_state tasks[STEP];
  for (size_t first = 0; first < chunks; first += STEP) {
    size_t count = chunks - first < STEP ? chunks - first : STEP;
    for (size_t t = 0; t < count; t++) {
      lists[first + t].axis = axis;
      tasks[t] = (task_state){&lists[first + t], grid->context, VXM_OK, VXM_ERROR_INIT};
    }
    search s = {grid, tasks, first};
    vxm_parallel(grid->context, count, run_task, &s);
    for (size_t t = 0; t < count; t++) {
      if (tasks[t].status != VXM_OK) {
        vxm_error_pass(error, &tasks[t].error);
        return tasks[t].status;
      }
      all->count += tasks[t].list->count;
    }
    if (all->count > RECTANGLES_MAX)
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "the surface has more than 2^30 rectangles; lower the resolution");
    vxm_status status = vxm_progress(grid->context, "finding faces",
                                     ((double)axis + (double)(first + count) / (double)chunks) / 3, error);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

vxm_status vxm_greedy_quads_find(vxm_greedy_quads *out, const vxm_grid *grid, vxm_error *error) {
  size_t chunks[3] = {grid->row_words, ((size_t)grid->space.dims[1] + LAYERS - 1) / LAYERS,
                      ((size_t)grid->space.dims[2] + LAYERS - 1) / LAYERS};
  *out = (vxm_greedy_quads){.context = grid->context, .list_count = chunks[0] + chunks[1] + chunks[2]};
  vxm_status status = VXM_OK;
  out->lists = vxm_try_calloc(grid->context, out->list_count, sizeof *out->lists, &status, error);
  if (!out->lists)
    return status;
  vxm_greedy_quad_list *lists = out->lists;
  for (int axis = 0; status == VXM_OK && axis < 3; lists += chunks[axis++])
    status = find_axis(out, grid, lists, chunks[axis], axis, error);
  if (status != VXM_OK)
    vxm_greedy_quads_destroy(out);
  return status;
}

void vxm_greedy_quads_destroy(vxm_greedy_quads *quads) {
  for (size_t l = 0; quads->lists && l < quads->list_count; l++)
    vxm_free(quads->context, quads->lists[l].items);
  vxm_free(quads->context, quads->lists);
  quads->lists = NULL;
}
