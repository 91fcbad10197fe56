/* SPDX-License-Identifier: BSD-3-Clause */
/** What binvox does with voxels once they are made: 64 of a row at a time. */
#include "cli/binvox.h"

#include <stdlib.h>
#include <string.h>

static int64_t rows_of(const binvox_bits *bits) {
  return bits->space.dims[1] * bits->space.dims[2];
}

static size_t words_of(const binvox_bits *bits) {
  return (size_t)(bits->row_words * rows_of(bits));
}

/** Row (j,k), or one without voxels where there is none. */
static const uint64_t *row_at(const binvox_bits *bits, const uint64_t *none, int64_t j, int64_t k) {
  const int64_t *dims = bits->space.dims;
  if (j < 0 || k < 0 || j >= dims[1] || k >= dims[2])
    return none;
  return bits->words + (k * dims[1] + j) * bits->row_words;
}

/** The bits of word w of a row that are voxels. */
static uint64_t mask_of(const binvox_bits *bits, int64_t w) {
  int64_t rest = bits->space.dims[0] - 64 * w;
  return rest >= 64 ? UINT64_MAX : (UINT64_C(1) << rest) - 1;
}

static bool allocate(binvox_bits *out, const vxm_space *space) {
  *out = (binvox_bits){.space = *space, .row_words = (space->dims[0] + 63) / 64};
  out->words = calloc(words_of(out) + 1, sizeof *out->words); /* cannot be too many: as many were in a grid */
  return out->words != NULL;
}

static void replace(binvox_bits *bits, const binvox_bits *by) {
  free(bits->words);
  *bits = *by;
}

bool binvox_bits_read(binvox_bits *out, const vxm_grid *grid) {
  if (!allocate(out, vxm_grid_space(grid)))
    return false;
  memcpy(out->words, vxm_grid_words(grid), words_of(out) * sizeof *out->words);
  return true;
}

void binvox_bits_free(binvox_bits *bits) {
  free(bits->words);
  bits->words = NULL;
}

bool binvox_bits_get(const binvox_bits *bits, int64_t i, int64_t j, int64_t k) {
  const int64_t *dims = bits->space.dims;
  return i >= 0 && i < dims[0] && j >= 0 && j < dims[1] && k >= 0 && k < dims[2] &&
         (bits->words[(k * dims[1] + j) * bits->row_words + i / 64] >> (i % 64) & 1);
}

int64_t binvox_count(const binvox_bits *bits) {
  int64_t count = 0;
  for (size_t w = 0; w < words_of(bits); w++)
    count += __builtin_popcountll(bits->words[w]);
  return count;
}

/* ---- Carving ---- */

/** Marks what is seen along x: all before the first voxel of a row that is set, and behind the last. */
static void see_along_x(binvox_bits *seen, const binvox_bits *bits) {
  for (int64_t row = 0; row < rows_of(bits); row++) {
    const uint64_t *in = bits->words + row * bits->row_words;
    uint64_t *out = seen->words + row * bits->row_words;
    int64_t first = 0, last = bits->row_words - 1;
    for (; first < bits->row_words && in[first] == 0; first++)
      out[first] = UINT64_MAX;
    for (; last > first && in[last] == 0; last--)
      out[last] = UINT64_MAX;
    if (first == bits->row_words)
      continue;
    out[first] |= (in[first] & -in[first]) - 1;
    int top = 63 - __builtin_clzll(in[last]);
    out[last] |= top == 63 ? 0 : UINT64_MAX << (top + 1);
  }
}

/** Marks what is seen from both ends of a column of rows, `step` words apart. */
static void see_column(uint64_t *seen, const uint64_t *words, int64_t count, int64_t step) {
  uint64_t open = UINT64_MAX;
  for (int64_t n = 0; n < count && open; n++) {
    open &= ~words[n * step];
    seen[n * step] |= open;
  }
  open = UINT64_MAX;
  for (int64_t n = count - 1; n >= 0 && open; n--) {
    open &= ~words[n * step];
    seen[n * step] |= open;
  }
}

bool binvox_carve(binvox_bits *bits) {
  const int64_t *dims = bits->space.dims;
  int64_t row = bits->row_words, slice = row * dims[1];
  binvox_bits seen;
  if (!allocate(&seen, &bits->space))
    return false;
  see_along_x(&seen, bits);
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t w = 0; w < row; w++)
      see_column(seen.words + k * slice + w, bits->words + k * slice + w, dims[1], row);
  for (int64_t w = 0; w < slice; w++)
    see_column(seen.words + w, bits->words + w, dims[2], slice);
  for (size_t w = 0; w < words_of(bits); w++)
    bits->words[w] = ~seen.words[w] & mask_of(bits, (int64_t)w % row);
  binvox_bits_free(&seen);
  return true;
}

/* ---- Neighbours ---- */

/** Dilation sets the voxels of which one of the six neighbours, or the voxel itself, is set; else the voxels
 * are kept that have an empty neighbour. */
static bool combine_neighbours(binvox_bits *bits, bool is_dilation) {
  const int64_t *dims = bits->space.dims;
  binvox_bits made;
  uint64_t *none = calloc((size_t)bits->row_words, sizeof *none);
  if (!none || !allocate(&made, &bits->space)) {
    free(none);
    return false;
  }
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++) {
      const uint64_t *row = row_at(bits, none, j, k);
      const uint64_t *a = row_at(bits, none, j - 1, k), *b = row_at(bits, none, j + 1, k);
      const uint64_t *c = row_at(bits, none, j, k - 1), *d = row_at(bits, none, j, k + 1);
      uint64_t *out = made.words + (k * dims[1] + j) * bits->row_words;
      for (int64_t w = 0; w < bits->row_words; w++) {
        uint64_t left = row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 0);
        uint64_t right = row[w] >> 1 | (w + 1 < bits->row_words ? row[w + 1] << 63 : 0);
        out[w] = is_dilation ? (row[w] | left | right | a[w] | b[w] | c[w] | d[w]) & mask_of(bits, w)
                             : row[w] & ~(left & right & a[w] & b[w] & c[w] & d[w]);
      }
    }
  free(none);
  replace(bits, &made);
  return true;
}

bool binvox_dilate(binvox_bits *bits) {
  return combine_neighbours(bits, true);
}

bool binvox_remove_internal(binvox_bits *bits) {
  return combine_neighbours(bits, false);
}

/* ---- Other sizes ---- */

static int count_eight(const binvox_bits *bits, int64_t i, int64_t j, int64_t k) {
  int count = 0;
  for (int n = 0; n < 8; n++)
    count += binvox_bits_get(bits, 2 * i + (n & 1), 2 * j + (n >> 1 & 1), 2 * k + (n >> 2));
  return count;
}

bool binvox_halve(binvox_bits *bits, int64_t least) {
  vxm_space space = bits->space;
  for (int axis = 0; axis < 3; axis++) {
    space.dims[axis] = (space.dims[axis] + 1) / 2;
    space.voxel_size[axis] *= 2;
  }
  binvox_bits made;
  if (!allocate(&made, &space))
    return false;
  for (int64_t k = 0; k < space.dims[2]; k++)
    for (int64_t j = 0; j < space.dims[1]; j++)
      for (int64_t i = 0; i < space.dims[0]; i++)
        if (count_eight(bits, i, j, k) >= least)
          made.words[(k * space.dims[1] + j) * made.row_words + i / 64] |= UINT64_C(1) << (i % 64);
  replace(bits, &made);
  return true;
}

static void widen(int64_t low[3], int64_t high[3], int axis, int64_t at) {
  low[axis] = at < low[axis] ? at : low[axis];
  high[axis] = at > high[axis] ? at : high[axis];
}

bool binvox_box(int64_t low[3], int64_t high[3], const binvox_bits *bits) {
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = bits->space.dims[axis];
    high[axis] = -1;
  }
  for (int64_t row = 0; row < rows_of(bits); row++)
    for (int64_t w = 0; w < bits->row_words; w++) {
      uint64_t word = bits->words[row * bits->row_words + w];
      if (word == 0)
        continue;
      widen(low, high, 0, 64 * w + __builtin_ctzll(word));
      widen(low, high, 0, 64 * w + 63 - __builtin_clzll(word));
      widen(low, high, 1, row % bits->space.dims[1]);
      widen(low, high, 2, row / bits->space.dims[1]);
    }
  return high[0] >= 0;
}

bool binvox_crop(binvox_bits *bits) {
  int64_t low[3], high[3];
  vxm_space space = bits->space;
  if (!binvox_box(low, high, bits))
    return true;
  for (int axis = 0; axis < 3; axis++) {
    space.dims[axis] = high[axis] - low[axis] + 1;
    space.origin[axis] += (double)low[axis] * space.voxel_size[axis];
  }
  binvox_bits made;
  if (!allocate(&made, &space))
    return false;
  int64_t first = low[0] / 64, shift = low[0] % 64;
  for (int64_t k = 0; k < space.dims[2]; k++)
    for (int64_t j = 0; j < space.dims[1]; j++) {
      const uint64_t *in = row_at(bits, NULL, j + low[1], k + low[2]);
      uint64_t *out = made.words + (k * space.dims[1] + j) * made.row_words;
      for (int64_t w = 0; w < made.row_words; w++) {
        uint64_t upper = shift && first + w + 1 < bits->row_words ? in[first + w + 1] << (64 - shift) : 0;
        out[w] = (in[first + w] >> shift | upper) & mask_of(&made, w);
      }
    }
  replace(bits, &made);
  return true;
}
