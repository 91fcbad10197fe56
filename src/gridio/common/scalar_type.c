/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/scalar_type.h"
#include "base/endian.h"
#include "base/threads.h"

enum { ROWS_PER_TASK = 64, ROWS_PER_STEP = 1 << 16 };

/** What 1 is, the first byte lowest. */
static uint64_t find_one(char kind, size_t size, bool big_endian) {
  uint64_t one = 1;
  if (kind == 'f')
    one = size == 2 ? 0x3c00 : size == 4 ? 0x3f800000 : UINT64_C(0x3ff0000000000000);
  return big_endian ? __builtin_bswap64(one) >> 8 * (8 - size) : one;
}

vxm_scalar_type vxm_scalar_type_of(char kind, size_t size, bool big_endian) {
  vxm_scalar_type e = {size, vxm_low_bits((unsigned)size * 8), find_one(kind, size, big_endian), kind == 'b',
                       kind == 'u' && size == 1};
  if (kind == 'f')
    e.mask &= ~(UINT64_C(0x80) << (big_endian ? 0 : 8 * (size - 1)));
  return e;
}

bool vxm_scalar_type_may_be_bits(vxm_scalar_type element, vxm_bits_rule rule) {
  return rule != VXM_BITS_STORED || element.is_bool || element.is_byte;
}

bool vxm_seen_bits(unsigned seen, vxm_scalar_type element, vxm_bits_rule rule) {
  if (rule == VXM_BITS_NONE || element.is_bool)
    return true;
  if (!vxm_scalar_type_may_be_bits(element, rule) || (seen & VXM_SEEN_OTHER))
    return false;
  if (seen & VXM_SEEN_FULL)
    return rule == VXM_BITS_ANY && element.is_byte && (seen & VXM_SEEN_ZERO) && !(seen & VXM_SEEN_ONE);
  return true;
}

/** Bits of up to 64 consecutive elements; `size` is a constant where this is inlined. */
static inline __attribute__((always_inline)) uint64_t pack_elements(const unsigned char *from, size_t size,
                                                                    uint64_t mask, uint64_t one, size_t count,
                                                                    unsigned *seen) {
  uint64_t word = 0, others = 0;
  for (size_t n = 0; n < count; n++) {
    uint64_t value = 0;
    memcpy(&value, from + n * size, size);
    value = vxm_le64(value);
    /* -1 is not 1, though its sign is masked for the question whether it is 0. */
    others |= (uint64_t)((value & mask) != 0 && value != one) << n;
    word |= (uint64_t)((value & mask) != 0) << n;
  }
  if (others)
    *seen |= VXM_SEEN_OTHER;
  return word;
}

/** Of bytes, 255 is told apart from others. */
static void see_bytes(const unsigned char *from, size_t count, unsigned *seen) {
  for (size_t n = 0; n < count; n++)
    if (from[n] > 1)
      *seen |= from[n] == 255 ? VXM_SEEN_FULL : VXM_SEEN_OTHER;
    else if (from[n] == 1)
      *seen |= VXM_SEEN_ONE;
}

static uint64_t pack_bytes(const unsigned char *from, size_t count, unsigned *seen) {
  uint64_t word = 0, all = 0;
  size_t n = 0;
  for (; n + 8 <= count; n += 8) {
    uint64_t bytes = vxm_load_le64(from + n);
    all |= bytes;
    word |= vxm_pack_bytes(vxm_nonzero_bytes(bytes)) << n;
  }
  for (; n < count; n++) {
    all |= from[n];
    word |= (uint64_t)(from[n] != 0) << n;
  }
  if (all & ~UINT64_C(0x0101010101010101))
    see_bytes(from, count, seen);
  else if (word)
    *seen |= VXM_SEEN_ONE;
  return word;
}

static uint64_t pack_word(const unsigned char *from, vxm_scalar_type e, size_t count, unsigned *seen) {
  uint64_t word;
  if (e.size == 8)
    word = pack_elements(from, 8, e.mask, e.one, count, seen);
  else if (e.size == 4)
    word = pack_elements(from, 4, e.mask, e.one, count, seen);
  else if (e.size == 2)
    word = pack_elements(from, 2, e.mask, e.one, count, seen);
  else
    word = pack_bytes(from, count, seen);
  if (word != vxm_low_bits((unsigned)count))
    *seen |= VXM_SEEN_ZERO;
  return word;
}

typedef struct loading {
  const unsigned char *data; /**< of row 0 of this step */
  vxm_scalar_type e;
  size_t rows, length;
  const vxm_bit_transpose *planes; /**< NULL: rows of the grid itself, from `words` on */
  uint64_t *words;
  size_t row_words;
  atomic_uint *seen;
} loading;

static void load_rows(size_t task, int worker, void *payload) {
  (void)worker;
  const loading *l = payload;
  size_t begin = task * ROWS_PER_TASK,
         end = begin + ROWS_PER_TASK < l->rows ? begin + ROWS_PER_TASK : l->rows;
  unsigned seen = 0;
  for (size_t r = begin; r < end; r++) {
    uint64_t *row = l->planes ? vxm_plane_row(l->planes, r / l->planes->rows, r % l->planes->rows)
                              : l->words + r * l->row_words;
    const unsigned char *from = l->data + r * l->length * l->e.size;
    for (size_t n = 0; n < l->length; n += 64)
      row[n / 64] = pack_word(from + n * l->e.size, l->e, l->length - n < 64 ? l->length - n : 64, &seen);
  }
  atomic_fetch_or(l->seen, seen);
}

static void load(vxm_context *context, loading *l) {
  vxm_parallel(context, (l->rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, load_rows, l);
}

void vxm_scalar_types_to_rows(vxm_grid *grid, size_t row, size_t rows, const unsigned char *data,
                              vxm_scalar_type element, atomic_uint *seen) {
  loading l = {.data = data,
               .seen = seen,
               .e = element,
               .rows = rows,
               .length = (size_t)grid->space.dims[0],
               .words = grid->words + row * grid->row_words,
               .row_words = grid->row_words};
  load(grid->context, &l);
}

void vxm_scalar_types_to_planes(const vxm_bit_transpose *planes, size_t count, const unsigned char *data,
                                vxm_scalar_type element, atomic_uint *seen) {
  loading l = {.data = data,
               .seen = seen,
               .e = element,
               .rows = count * planes->rows,
               .length = planes->length,
               .planes = planes};
  load(planes->context, &l);
}

vxm_status vxm_scalar_types_to_grid(vxm_grid *grid, const unsigned char *data, vxm_scalar_type element,
                                    atomic_uint *seen, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t all = grid->word_count / grid->row_words, length = (size_t)grid->space.dims[0] * element.size;
  for (size_t row = 0; status == VXM_OK && row < all; row += ROWS_PER_STEP) {
    size_t rows = all - row < ROWS_PER_STEP ? all - row : ROWS_PER_STEP;
    vxm_scalar_types_to_rows(grid, row, rows, data + row * length, element, seen);
    status = vxm_progress(grid->context, "reading", (double)(row + rows) / (double)all, error);
  }
  return status;
}
