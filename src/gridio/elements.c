/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/elements.h"
#include "base/threads.h"
#include "gridio/bytes.h"

enum { ROWS_PER_TASK = 64, ROWS_PER_STEP = 1 << 16 };

vxm_element vxm_element_of(char kind, size_t size, bool big_endian) {
  vxm_element e = {size, vxm_low_bits((unsigned)size * 8)};
  if (kind == 'f')
    e.mask &= ~(UINT64_C(0x80) << (big_endian ? 0 : 8 * (size - 1)));
  return e;
}

/** Bits of up to 64 consecutive elements; `size` is a constant where this is inlined. */
static inline __attribute__((always_inline)) uint64_t pack_elements(const unsigned char *from, size_t size,
                                                                    uint64_t mask, size_t count) {
  uint64_t word = 0;
  for (size_t n = 0; n < count; n++) {
    uint64_t value = 0;
    memcpy(&value, from + n * size, size);
    word |= (uint64_t)((vxm_le64(value) & mask) != 0) << n;
  }
  return word;
}

static uint64_t pack_word(const unsigned char *from, vxm_element e, size_t count) {
  if (e.size == 8)
    return pack_elements(from, 8, e.mask, count);
  if (e.size == 4)
    return pack_elements(from, 4, e.mask, count);
  if (e.size == 2)
    return pack_elements(from, 2, e.mask, count);
  uint64_t word = 0;
  size_t n = 0;
  for (; n + 8 <= count; n += 8)
    word |= vxm_pack_bytes(vxm_nonzero_bytes(vxm_load_le64(from + n))) << n;
  return n < count ? word | pack_elements(from + n, 1, e.mask, count - n) << n : word;
}

typedef struct loading {
  const unsigned char *data; /**< of row 0 of this step */
  vxm_element e;
  size_t rows, length;
  const vxm_planes *planes; /**< NULL: rows of the grid itself, from `words` on */
  uint64_t *words;
  size_t row_words;
} loading;

static void load_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const loading *l = payload;
  size_t begin = task * ROWS_PER_TASK,
         end = begin + ROWS_PER_TASK < l->rows ? begin + ROWS_PER_TASK : l->rows;
  for (size_t r = begin; r < end; r++) {
    uint64_t *row = l->planes ? vxm_plane_row(l->planes, r / l->planes->rows, r % l->planes->rows)
                              : l->words + r * l->row_words;
    const unsigned char *from = l->data + r * l->length * l->e.size;
    for (size_t n = 0; n < l->length; n += 64)
      row[n / 64] = pack_word(from + n * l->e.size, l->e, l->length - n < 64 ? l->length - n : 64);
  }
}

static void load(vxm_context *context, loading *l) {
  vxm_parallel(context, (l->rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, load_rows, l);
}

void vxm_elements_to_rows(vxm_grid *grid, size_t row, size_t rows, const unsigned char *data,
                          vxm_element element) {
  loading l = {.data = data,
               .e = element,
               .rows = rows,
               .length = (size_t)grid->space.dims[0],
               .words = grid->words + row * grid->row_words,
               .row_words = grid->row_words};
  load(grid->context, &l);
}

void vxm_elements_to_planes(const vxm_planes *planes, size_t count, const unsigned char *data,
                            vxm_element element) {
  loading l = {
      .data = data, .e = element, .rows = count * planes->rows, .length = planes->length, .planes = planes};
  load(planes->context, &l);
}

vxm_status vxm_elements_to_grid(vxm_grid *grid, const unsigned char *data, vxm_element element,
                                vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t all = grid->word_count / grid->row_words, length = (size_t)grid->space.dims[0] * element.size;
  for (size_t row = 0; status == VXM_OK && row < all; row += ROWS_PER_STEP) {
    size_t rows = all - row < ROWS_PER_STEP ? all - row : ROWS_PER_STEP;
    vxm_elements_to_rows(grid, row, rows, data + row * length, element);
    status = vxm_progress(grid->context, "reading", (double)(row + rows) / (double)all, error);
  }
  return status;
}
