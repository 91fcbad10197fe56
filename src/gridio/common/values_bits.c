/* SPDX-License-Identifier: BSD-3-Clause */
/** Fields made into bits, and what has to be known of their numbers for that. */
#include "base/endian.h"
#include "base/sized.h"
#include "base/threads.h"
#include "grid/bit_transpose.h"
#include "gridio/common/values.h"

#include <math.h>
#include <string.h>

/** Numbers that are looked at together. */
enum { PIECE = 4096 };

static size_t pieces_of(const vxm_field *field) {
  return (vxm_field_count(field) + PIECE - 1) / PIECE;
}

/** The numbers of a piece; how many. */
static size_t load_piece(double out[PIECE], const vxm_field *field, size_t piece) {
  size_t begin = piece * PIECE, left = vxm_field_count(field) - begin, count = left < PIECE ? left : PIECE;
  vxm_field_doubles(out, field, begin, count);
  return count;
}

/* ---- The range ---- */

vxm_status vxm_field_measure(vxm_field_range *out, const vxm_field *field, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !field)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "field: an argument is NULL");
  double values[PIECE], least = INFINITY, greatest = -INFINITY;
  int64_t not_numbers = 0;
  for (size_t p = 0; p < pieces_of(field); p++) {
    size_t count = load_piece(values, field, p);
    for (size_t n = 0; n < count; n++) {
      least = values[n] < least ? values[n] : least;
      greatest = values[n] > greatest ? values[n] : greatest;
      not_numbers += values[n] != values[n];
    }
  }
  vxm_field_range found = {.not_numbers = not_numbers};
  if (least <= greatest) {
    found.min = least;
    found.max = greatest;
  }
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}

/* ---- Bits in another type ---- */

static unsigned see(const vxm_field *field) {
  double values[PIECE];
  unsigned seen = 0;
  for (size_t p = 0; p < pieces_of(field) && !(seen & VXM_SEEN_OTHER); p++) {
    size_t count = load_piece(values, field, p);
    for (size_t n = 0; n < count; n++)
      seen |= values[n] == 0     ? VXM_SEEN_ZERO
              : values[n] == 1   ? VXM_SEEN_ONE
              : values[n] == 255 ? VXM_SEEN_FULL
                                 : VXM_SEEN_OTHER;
  }
  return seen;
}

bool vxm_field_is_mask(const vxm_field *field) {
  if (!field)
    return false;
  const vxm_scalar_type element = {.size = vxm_scalar_bytes(field->scalar),
                                   .is_byte = field->scalar == VXM_UINT8};
  return vxm_about_may_be_bits(&field->about, VXM_BITS_ANY) && field->channels == 1 &&
         vxm_seen_bits(see(field), element, VXM_BITS_ANY);
}

vxm_status vxm_field_to_bits(vxm_grid **out, const vxm_field *field, const char *file, vxm_error *error) {
  vxm_threshold_options above = VXM_THRESHOLD_OPTIONS_INIT;
  *out = NULL;
  if (!vxm_field_is_mask(field))
    return vxm_fail_numbers(error, file, vxm_scalar_name(field->scalar));
  above.use_at_least = true;
  above.at_least = 1;
  return vxm_field_threshold(out, field, &above, error);
}

/* ---- The threshold ---- */

typedef struct cutting {
  const vxm_field *field;
  const vxm_threshold_options *options;
  const vxm_bit_transpose *planes;
  size_t first; /**< x of the first plane */
} cutting;

/** -0 lies below 0: among distances it is one from inside to the surface. */
static inline bool is_below(double value, double bound) {
  return value < bound || (value == 0 && bound == 0 && signbit(value));
}

static bool is_set(double value, const vxm_threshold_options *o) {
  return value == value && !(o->use_at_least && is_below(value, o->at_least)) &&
         (!o->use_below || is_below(value, o->below));
}

/** Whether a whole number of 64 bits, which a double may round, is less than a bound. */
static bool is_long_below(const vxm_field *field, size_t at, double bound) {
  double least = ceil(bound); /* what is below the bound is below the next whole number */
  if (field->scalar == VXM_UINT64) {
    uint64_t value = ((const uint64_t *)(const void *)field->values)[at];
    return least >= 0x1p64 || (least > 0 && value < (uint64_t)least);
  }
  int64_t value = ((const int64_t *)(const void *)field->values)[at];
  return least >= 0x1p63 || (least > -0x1p63 && value < (int64_t)least);
}

static bool is_long_set(const vxm_field *field, size_t at, const vxm_threshold_options *o) {
  return !(o->use_at_least && is_long_below(field, at, o->at_least)) &&
         (!o->use_below || is_long_below(field, at, o->below));
}

static void cut_piece(uint64_t *row, const cutting *c, size_t at, size_t count, size_t bit) {
  double values[PIECE];
  bool is_long = c->field->scalar == VXM_INT64 || c->field->scalar == VXM_UINT64;
  if (!is_long)
    vxm_field_doubles(values, c->field, at, count);
  for (size_t n = 0; n < count; n++) {
    bool set = is_long ? is_long_set(c->field, at + n, c->options) : is_set(values[n], c->options);
    row[(bit + n) / 64] |= (uint64_t)set << ((bit + n) % 64);
  }
}

static void cut_row(size_t task, int worker, void *payload) {
  (void)worker;
  const cutting *c = payload;
  size_t plane = task / c->planes->rows, j = task % c->planes->rows, length = c->planes->length,
         begin = ((c->first + plane) * c->planes->rows + j) * length;
  uint64_t *row = vxm_plane_row(c->planes, plane, j);
  for (size_t k = 0; k < length; k += PIECE)
    cut_piece(row, c, begin + k, length - k < PIECE ? length - k : PIECE, k);
}

static vxm_status cut(vxm_grid *grid, cutting *c, vxm_error *error) {
  vxm_bit_transpose planes;
  vxm_status status =
      vxm_bit_transpose_create(&planes, grid->context, &grid->space, (vxm_layout)VXM_PLANE_Z_FAST, error);
  if (status != VXM_OK)
    return status;
  c->planes = &planes;
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    c->first = w * 64;
    vxm_bit_transpose_clear(&planes);
    vxm_parallel(grid->context, vxm_bit_transpose_in(grid, w) * planes.rows, cut_row, c);
    vxm_bit_transpose_scatter(&planes, grid, w);
    status = vxm_progress(grid->context, "thresholding", (double)(w + 1) / (double)grid->row_words, error);
  }
  vxm_bit_transpose_destroy(&planes);
  return status;
}

static vxm_status choose_threshold(vxm_threshold_options *o, const vxm_threshold_options *options,
                                   vxm_error *error) {
  *o = (vxm_threshold_options)VXM_THRESHOLD_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(o, options, "threshold", error);
  if (status != VXM_OK)
    return status;
  if (!o->use_at_least && !o->use_below)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "threshold: neither at_least nor below is chosen; use one of them, or both");
  if ((o->use_at_least && isnan(o->at_least)) || (o->use_below && isnan(o->below)))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "threshold: a bound is not a number");
  return VXM_OK;
}

static void note_numbers(vxm_grid *grid, const vxm_field *field) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  if (!vxm_scalar_is_float(field->scalar) || vxm_field_measure(&range, field, NULL) != VXM_OK)
    return;
  if (range.not_numbers > 0)
    vxm_warn(&grid->warnings, "%lld values are not numbers: their voxels are clear",
             (long long)range.not_numbers);
}

vxm_status vxm_field_threshold(vxm_grid **out, const vxm_field *field, const vxm_threshold_options *options,
                               vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !field || !options)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "threshold: an argument is NULL");
  vxm_grid *grid = NULL;
  vxm_threshold_options chosen;
  vxm_status status = choose_threshold(&chosen, options, error);
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, field->context, &field->space, error);
  cutting c = {.field = field, .options = &chosen};
  if (status == VXM_OK)
    status = cut(grid, &c, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  note_numbers(grid, field);
  *out = grid;
  return VXM_OK;
}

/* ---- 32-bit floats ---- */

bool vxm_field_is_float_exactly(const vxm_field *field) {
  double values[PIECE];
  if (field->channels != 1)
    return false;
  if (field->scalar == VXM_FLOAT32 || vxm_scalar_bytes(field->scalar) < 4)
    return true;
  for (size_t p = 0; p < pieces_of(field); p++) {
    size_t count = load_piece(values, field, p);
    for (size_t n = 0; n < count; n++) {
      if (values[n] == values[n] && (double)(float)values[n] != values[n])
        return false;
      /* A double holds whole numbers up to 2^53, and has rounded those beyond. */
      if (!vxm_scalar_is_float(field->scalar) && fabs(values[n]) > 0x1p53)
        return false;
    }
  }
  return true;
}

#define NARROW(type, low, high)                                          \
  do {                                                                   \
    for (size_t n = 0; n < count; n++) {                                 \
      double value = (double)from[n];                                    \
      if (!(value >= (low) && value <= (high)) || value != trunc(value)) \
        return false;                                                    \
      if (to)                                                            \
        ((type *)to)[n] = (type)value;                                   \
    }                                                                    \
  } while (0)

/** The 16 bits of a float that has been made of them; false if it was not. */
static bool find_half(uint16_t *out, float value) {
  uint32_t word;
  memcpy(&word, &value, sizeof word);
  unsigned sign = word >> 31 << 15, exponent = word >> 23 & 255, fraction = word & 0x7fffff;
  if (exponent == 255)
    *out = (uint16_t)(sign | 0x7c00 | (fraction ? 0x200 : 0));
  else if (exponent >= 113)
    *out = (uint16_t)(sign | ((exponent - 112) << 10 & 0x7c00) | fraction >> 13);
  else
    *out = (uint16_t)(sign | (unsigned)lrintf(fabsf(value) * 0x1p24f));
  return exponent == 255 || (exponent <= 142 && vxm_half_value(*out) == value);
}

static bool narrow_half(uint16_t *to, const float *from, size_t count) {
  for (size_t n = 0; n < count; n++) {
    uint16_t half;
    if (!find_half(&half, from[n]))
      return false;
    if (to)
      to[n] = half;
  }
  return true;
}

static bool widen(double *to, const float *from, size_t count) {
  for (size_t n = 0; n < count && to; n++)
    to[n] = (double)from[n];
  return true;
}

/** Turns floats into those of another type, or, without `to`, tells whether that is exact. */
static bool narrow(void *to, const float *from, size_t count, vxm_scalar scalar) {
  switch (scalar) {
  case VXM_UINT8:
    NARROW(uint8_t, 0, UINT8_MAX);
    return true;
  case VXM_INT8:
    NARROW(int8_t, INT8_MIN, INT8_MAX);
    return true;
  case VXM_UINT16:
    NARROW(uint16_t, 0, UINT16_MAX);
    return true;
  case VXM_INT16:
    NARROW(int16_t, INT16_MIN, INT16_MAX);
    return true;
  case VXM_UINT32:
    NARROW(uint32_t, 0, UINT32_MAX);
    return true;
  case VXM_INT32:
    NARROW(int32_t, INT32_MIN, INT32_MAX);
    return true;
  case VXM_UINT64:
    NARROW(uint64_t, 0, 0x1p53);
    return true;
  case VXM_INT64:
    NARROW(int64_t, -0x1p53, 0x1p53);
    return true;
  case VXM_FLOAT16:
    return narrow_half(to, from, count);
  case VXM_FLOAT64:
    return widen(to, from, count);
  default:
    return false;
  }
}

vxm_status vxm_field_narrow(vxm_field *field, vxm_scalar scalar, vxm_error *error) {
  const float *from = (const float *)(void *)field->values;
  size_t count = vxm_field_count(field);
  if (scalar == VXM_FLOAT32 || !narrow(NULL, from, count, scalar))
    return VXM_OK;
  vxm_status status = VXM_OK;
  unsigned char *values = vxm_try_alloc(field->context, count, vxm_scalar_bytes(scalar), &status, error);
  if (!values)
    return status;
  narrow(values, from, count, scalar);
  vxm_free(field->context, field->values);
  field->values = values;
  field->scalar = scalar;
  return VXM_OK;
}
