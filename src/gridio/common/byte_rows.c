/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/byte_rows.h"
#include "base/endian.h"
#include "base/threads.h"
#include "gridio/common/values_writer.h"

enum { CHUNK = 1 << 22, ROWS_PER_TASK = 64 };

/** Rows that are turned into bytes together, at most CHUNK of them; a row is below 2^20 + 1. */
static size_t chunk_rows(const vxm_space *space, vxm_layout layout) {
  size_t all = (size_t)space->dims[layout.middle] * (size_t)space->dims[layout.slow],
         rows = CHUNK / (size_t)space->dims[layout.fast];
  return rows < all ? rows : all;
}

size_t vxm_byte_rows_bytes(const vxm_space *space, vxm_layout layout) {
  return chunk_rows(space, layout) * (size_t)space->dims[layout.fast];
}

typedef struct storing {
  const vxm_window *window;
  unsigned char *bytes;
  size_t row, rows; /**< those in `bytes`, counted over all slices of the window */
} storing;

static void store_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const storing *s = payload;
  size_t begin = task * ROWS_PER_TASK, length = (size_t)s->window->fast_dim,
         end = begin + ROWS_PER_TASK < s->rows ? begin + ROWS_PER_TASK : s->rows;
  for (size_t r = begin; r < end; r++) {
    int64_t row = (int64_t)(s->row + r), middles = s->window->middle_dim;
    vxm_unpack_words(s->bytes + r * length,
                     vxm_window_row(s->window, row % middles, s->window->begin + row / middles), length);
  }
}

vxm_status vxm_byte_rows_put(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  size_t rows = (size_t)(window->end - window->begin) * (size_t)window->middle_dim,
         most = chunk_rows(&writer->space, window->layout);
  for (size_t row = 0; row < rows; row += most) {
    storing s = {window, writer->state, row, rows - row < most ? rows - row : most};
    vxm_parallel(writer->context, (s.rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, store_rows, &s);
    vxm_output_write(writer->output, s.bytes, s.rows * (size_t)window->fast_dim);
    vxm_status status = vxm_grid_writer_step_rows(writer, window, row + s.rows, error);
    if (status != VXM_OK)
      return status;
  }
  return VXM_OK;
}

/* ---- Into formats that take numbers ---- */

/** Whole slices that are turned into bytes together: CHUNK bytes, or one. */
static size_t chunk_slices(const vxm_space *space, vxm_layout layout) {
  size_t slice = (size_t)space->dims[layout.fast] * (size_t)space->dims[layout.middle],
         all = (size_t)space->dims[layout.slow], slices = CHUNK / slice;
  slices = slices < all ? slices : all;
  return slices > 0 ? slices : 1;
}

/** Rows at once: some, or those of whole slices. */
static size_t rows_at_once(const vxm_values_writer_kind *kind, const vxm_space *space) {
  return kind->put ? chunk_slices(space, kind->layout) * (size_t)space->dims[kind->layout.middle]
                   : chunk_rows(space, kind->layout);
}

size_t vxm_byte_rows_values_bytes(const vxm_values_writer_kind *kind, const vxm_space *space) {
  return rows_at_once(kind, space) * (size_t)space->dims[kind->layout.fast];
}

vxm_status vxm_byte_rows_put_values(vxm_grid_writer *writer, const vxm_window *window, vxm_error *error) {
  const vxm_values_writer_kind *kind = writer->format->values;
  size_t in_slice = (size_t)window->middle_dim, rows = (size_t)(window->end - window->begin) * in_slice,
         most = rows_at_once(kind, &writer->space);
  vxm_status status = VXM_OK;
  for (size_t row = 0; row < rows && status == VXM_OK; row += most) {
    storing s = {window, writer->state, row, rows - row < most ? rows - row : most};
    vxm_parallel(writer->context, (s.rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, store_rows, &s);
    int64_t begin = window->begin + (int64_t)(row / in_slice);
    if (kind->put)
      status =
          vxm_values_writer_put(writer->values, s.bytes, begin, begin + (int64_t)(s.rows / in_slice), error);
    else
      status = vxm_values_writer_put_bytes(writer->values, s.bytes, s.rows * (size_t)window->fast_dim, error);
    if (status == VXM_OK)
      status = vxm_grid_writer_step_rows(writer, window, row + s.rows, error);
  }
  return status;
}
