/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/bit_transpose.h"
#include "base/threads.h"

#include <string.h>

enum { ROWS_PER_TASK = 16 };

static vxm_bit_transpose planes_of(const vxm_space *space, vxm_layout layout) {
  vxm_bit_transpose planes = {.layout = layout};
  planes.count = space->dims[0] < 64 ? (size_t)space->dims[0] : 64;
  planes.rows = (size_t)space->dims[layout.middle];
  planes.length = (size_t)space->dims[layout.fast];
  planes.row_words = (planes.length + 63) / 64;
  /* At most 2^20 rows of 2^14 words; the sum makes whole cache lines, an odd number of them. */
  planes.plane_words = ((planes.rows * planes.row_words + 7) / 8 | 1) * 8;
  return planes;
}

uint64_t vxm_bit_transpose_bytes(const vxm_space *space, vxm_layout layout) {
  vxm_bit_transpose planes = planes_of(space, layout);
  return (uint64_t)planes.count * planes.plane_words * sizeof *planes.words;
}

vxm_status vxm_bit_transpose_create(vxm_bit_transpose *out, vxm_context *context, const vxm_space *space,
                                    vxm_layout layout, vxm_error *error) {
  *out = planes_of(space, layout);
  out->context = context;
  vxm_status status = VXM_OK;
  out->words = vxm_try_calloc(context, out->count * out->plane_words, sizeof *out->words, &status, error);
  return status;
}

void vxm_bit_transpose_destroy(vxm_bit_transpose *planes) {
  vxm_free(planes->context, planes->words);
  planes->words = NULL;
}

void vxm_bit_transpose_clear(vxm_bit_transpose *planes) {
  memset(planes->words, 0, planes->count * planes->plane_words * sizeof *planes->words);
}

vxm_window vxm_bit_transpose_window(const vxm_bit_transpose *planes, const vxm_grid *grid, size_t word) {
  int64_t begin = (int64_t)(word * 64);
  vxm_window window =
      vxm_window_of(&grid->space, planes->layout, begin, begin + (int64_t)vxm_bit_transpose_in(grid, word));
  window.slice_words = planes->plane_words;
  window.words = planes->words;
  return window;
}

typedef struct move {
  const vxm_bit_transpose *planes;
  const vxm_grid *grid;
  size_t word, planes_used;
  vxm_row_word_fn load;
} move;

/** Word index in the grid of element 0 of a plane's row, and the step to the next element. */
static size_t row_start(const move *m, size_t row, size_t *step) {
  bool y_fast = m->planes->layout.fast == 1;
  *step = y_fast ? m->grid->row_words : m->grid->slice_words;
  return row * (y_fast ? m->grid->slice_words : m->grid->row_words);
}

static size_t task_count(const vxm_bit_transpose *planes) {
  return (planes->rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
}

static size_t task_end(const vxm_bit_transpose *planes, size_t task) {
  size_t end = (task + 1) * ROWS_PER_TASK;
  return end < planes->rows ? end : planes->rows;
}

static void gather_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const move *m = payload;
  const vxm_bit_transpose *planes = m->planes;
  for (size_t row = task * ROWS_PER_TASK; row < task_end(planes, task); row++) {
    size_t step, start = row_start(m, row, &step);
    for (size_t w = 0; w < planes->row_words; w++) {
      uint64_t block[64], any = 0, all = ~UINT64_C(0);
      size_t used = planes->length - w * 64 < 64 ? planes->length - w * 64 : 64;
      for (size_t e = 0; e < used; e++) {
        const uint64_t *source = m->grid->words + start + (w * 64 + e) * step;
        block[e] = m->load ? m->load(source, m->word, m->grid->row_words) : source[m->word];
        any |= block[e];
        all &= block[e];
      }
      memset(block + used, 0, (64 - used) * sizeof *block);
      if (any && (used < 64 || ~all)) /* all clear and all set are their own transposes */
        vxm_transpose64(block);
      for (size_t p = 0; p < m->planes_used; p++)
        vxm_plane_row(planes, p, row)[w] = block[p];
    }
  }
}

void vxm_bit_transpose_gather(vxm_bit_transpose *planes, const vxm_grid *grid, size_t word,
                              vxm_row_word_fn load) {
  move m = {planes, grid, word, vxm_bit_transpose_in(grid, word), load};
  vxm_parallel(grid->context, task_count(planes), gather_rows, &m);
}

static void scatter_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const move *m = payload;
  const vxm_bit_transpose *planes = m->planes;
  for (size_t row = task * ROWS_PER_TASK; row < task_end(planes, task); row++) {
    size_t step, start = row_start(m, row, &step);
    for (size_t w = 0; w < planes->row_words; w++) {
      uint64_t block[64] = {0}, any = 0;
      for (size_t p = 0; p < m->planes_used; p++) {
        block[p] = vxm_plane_row(planes, p, row)[w];
        any |= block[p];
      }
      if (any)
        vxm_transpose64(block);
      size_t used = planes->length - w * 64 < 64 ? planes->length - w * 64 : 64;
      for (size_t e = 0; e < used; e++)
        m->grid->words[start + (w * 64 + e) * step + m->word] = block[e];
    }
  }
}

void vxm_bit_transpose_scatter(const vxm_bit_transpose *planes, vxm_grid *grid, size_t word) {
  move m = {planes, grid, word, vxm_bit_transpose_in(grid, word), NULL};
  vxm_parallel(grid->context, task_count(planes), scatter_rows, &m);
}
