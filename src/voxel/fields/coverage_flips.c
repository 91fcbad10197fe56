/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/fields/coverage_flips.h"
#include "base/bits.h"

/* Functions that are made anew for each number of sub-voxels, where `shift` is a constant. */
#define ALWAYS __attribute__((always_inline))
#define BY_SHIFT(f, function, ...)              \
  ((f)->shift == 1   ? function(__VA_ARGS__, 1) \
   : (f)->shift == 2 ? function(__VA_ARGS__, 2) \
                     : function(__VA_ARGS__, 3))

/* ---- Rows ---- */

vxm_coverage_flips vxm_coverage_flips_of(int n, size_t row_length) {
  vxm_coverage_flips flips = {.shift = n == 2 ? 1 : n == 4 ? 2 : 3, .row_length = row_length};
  while (((size_t)n * row_length - 1) >> flips.place_bits)
    flips.place_bits++;
  /* An odd number of words of `touched`: rows do not begin in the same few sets of the cache. */
  flips.stride = 64 * (((row_length - 1) / 64 + 1) | 1);
  return flips;
}

static size_t words_of(const vxm_coverage_flips *flips, size_t rows) {
  return (rows * flips->stride << 3 * flips->shift) / 64;
}

uint64_t vxm_coverage_flips_bytes(const vxm_coverage_flips *flips, size_t rows) {
  return (words_of(flips, rows) + rows * flips->stride / 64 + rows / 64 + 1) * sizeof(uint64_t);
}

vxm_status vxm_coverage_flips_make(vxm_coverage_flips *flips, vxm_context *context, size_t rows,
                                   vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  flips->rows = rows;
  flips->words = vxm_calloc(context, words_of(flips, rows), sizeof *flips->words, &local);
  flips->touched = vxm_calloc(context, rows * flips->stride / 64, sizeof *flips->touched, &local);
  flips->touched_rows = vxm_calloc(context, rows / 64 + 1, sizeof *flips->touched_rows, &local);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

void vxm_coverage_flips_destroy(vxm_coverage_flips *flips, vxm_context *context) {
  vxm_free(context, flips->touched_rows);
  vxm_free(context, flips->touched);
  vxm_free(context, flips->words);
}

/* ---- Flips ---- */

static inline void set_bit(uint64_t *words, size_t bit) {
  words[bit / 64] |= UINT64_C(1) << bit % 64;
}

static inline ALWAYS void flip(const vxm_coverage_flips *f, size_t first, const uint64_t *places,
                               size_t count, int shift) {
  uint64_t *words = f->words, *touched = f->touched, *touched_rows = f->touched_rows;
  const int bits = f->place_bits;
  const uint64_t along = vxm_low_bits((unsigned)bits), within = vxm_low_bits((unsigned)shift),
                 across = vxm_low_bits(2 * (unsigned)shift);
  const size_t stride = f->stride, rows = f->rows;
  for (size_t i = 0; i < count; i++) {
    uint64_t at = places[i] & along, thin_row = places[i] >> bits;
    size_t row = (size_t)(thin_row >> 2 * shift) - first;
    if (row >= rows)
      continue;
    size_t voxel = row * stride + (size_t)(at >> shift);
    size_t bit = voxel << 3 * shift | (size_t)((at & within) << 2 * shift | (thin_row & across));
    words[bit / 64] ^= UINT64_C(1) << bit % 64;
    set_bit(touched, voxel);
    set_bit(touched_rows, row);
  }
}

void vxm_coverage_flip(vxm_coverage_flips *f, size_t first, const uint64_t *places, size_t count) {
  BY_SHIFT(f, flip, f, first, places, count);
}

/* ---- Voxels ---- */

/** What the voxels of a row are like, from the first on. */
typedef struct voxel_bits {
  uint64_t word[8]; /**< of n^3 bits */
  uint64_t inside;  /**< rows of sub-voxels that are inside as it begins, then as it ends */
} voxel_bits;

/** Takes the flips of a voxel, which are cleared, and folds them. */
static inline ALWAYS void fold(voxel_bits *v, uint64_t *words, size_t voxel, int shift) {
  if (shift == 1) {
    uint64_t *word = &words[voxel / 8], flips = *word >> voxel % 8 * 8 & 0xff;
    *word ^= flips << voxel % 8 * 8;
    v->word[0] = (flips ^ flips << 4 ^ v->inside * 0x11) & 0xff;
    v->inside = v->word[0] >> 4;
  } else if (shift == 2) {
    uint64_t flips = words[voxel];
    words[voxel] = 0;
    flips ^= flips << 16;
    v->word[0] = flips ^ flips << 32 ^ v->inside * UINT64_C(0x0001000100010001);
    v->inside = v->word[0] >> 48;
  } else
    for (size_t i = 0; i < 8; i++) {
      v->inside ^= words[8 * voxel + i];
      words[8 * voxel + i] = 0;
      v->word[i] = v->inside;
    }
}

/** The other way round: the flips that make a voxel's bits; `inside` as it begins, then as it ends. */
static inline ALWAYS void unfold(const voxel_bits *v, uint64_t *inside, uint64_t *words, size_t voxel,
                                 int shift) {
  if (shift == 1) {
    words[voxel / 8] |= ((v->word[0] ^ v->word[0] << 4 ^ *inside) & 0xff) << voxel % 8 * 8;
    *inside = v->word[0] >> 4;
  } else if (shift == 2) {
    words[voxel] = v->word[0] ^ v->word[0] << 16 ^ *inside;
    *inside = v->word[0] >> 48;
  } else
    for (size_t i = 0; i < 8; i++) {
      words[8 * voxel + i] = v->word[i] ^ *inside;
      *inside = v->word[i];
    }
}

static inline ALWAYS unsigned count_bits(const voxel_bits *v, int shift) {
  unsigned count = 0;
  for (int i = 0; i < (shift == 3 ? 8 : 1); i++)
    count += (unsigned)vxm_popcount(v->word[i]);
  return count;
}

/* ---- Several parts ---- */

/** Whether a voxel has flips: the first one of a row that has some has sub-voxels that are set. */
static inline ALWAYS bool has_flips(const uint64_t *words, size_t voxel, int shift) {
  if (shift < 3)
    return shift == 2 ? words[voxel] != 0 : (words[voxel / 8] >> voxel % 8 * 8 & 0xff) != 0;
  uint64_t any = 0;
  for (size_t i = 0; i < 8; i++)
    any |= words[8 * voxel + i];
  return any != 0;
}

static inline ALWAYS bool any_flips(const vxm_coverage_flips *f, int shift) {
  for (size_t r = 0; r <= f->rows / 64; r++)
    for (uint64_t rows = f->touched_rows[r]; rows; rows &= rows - 1) {
      size_t w = (64 * r + (size_t)__builtin_ctzll(rows)) * f->stride / 64;
      for (size_t end = w + f->stride / 64; w < end; w++)
        for (uint64_t left = f->touched[w]; left; left &= left - 1)
          if (has_flips(f->words, 64 * w + (size_t)__builtin_ctzll(left), shift))
            return true;
    }
  return false;
}

bool vxm_coverage_flips_any(const vxm_coverage_flips *f) {
  return BY_SHIFT(f, any_flips, f);
}

/** A row that has flips in `from`. Returns the OR of what was not set. */
static inline ALWAYS uint64_t unite_row(vxm_coverage_flips *f, vxm_coverage_flips *from, size_t row,
                                        int shift) {
  voxel_bits ours = {{0}, 0}, theirs = {{0}, 0};
  uint64_t inside = 0, added = 0;
  for (size_t w = row * f->stride / 64, end = w + f->stride / 64; w < end; w++) {
    uint64_t left = f->touched[w] |= from->touched[w];
    from->touched[w] = 0;
    for (; left; left &= left - 1) {
      size_t voxel = 64 * w + (size_t)__builtin_ctzll(left);
      fold(&ours, f->words, voxel, shift);
      fold(&theirs, from->words, voxel, shift);
      voxel_bits both = ours;
      for (int i = 0; i < (shift == 3 ? 8 : 1); i++) {
        both.word[i] |= theirs.word[i];
        added |= both.word[i] ^ ours.word[i];
      }
      unfold(&both, &inside, f->words, voxel, shift);
    }
  }
  return added;
}

static inline ALWAYS bool unite(vxm_coverage_flips *f, vxm_coverage_flips *from, int shift) {
  uint64_t added = 0;
  for (size_t r = 0; r <= f->rows / 64; r++) {
    for (uint64_t rows = from->touched_rows[r]; rows; rows &= rows - 1)
      added |= unite_row(f, from, 64 * r + (size_t)__builtin_ctzll(rows), shift);
    f->touched_rows[r] |= from->touched_rows[r];
    from->touched_rows[r] = 0;
  }
  return added != 0;
}

bool vxm_coverage_flips_unite(vxm_coverage_flips *f, vxm_coverage_flips *from) {
  return BY_SHIFT(f, unite, f, from);
}

/* ---- Values ---- */

static inline ALWAYS void put_row(const vxm_coverage_flips *f, size_t row, vxm_coverage_writer *writer,
                                  int shift) {
  size_t begin = row * f->stride, done = begin;
  voxel_bits bits = {{0}, 0};
  unsigned count = 0;
  for (size_t w = begin / 64; w < (begin + f->stride) / 64; w++) {
    uint64_t left = f->touched[w];
    f->touched[w] = 0;
    for (; left; left &= left - 1) {
      size_t voxel = 64 * w + (size_t)__builtin_ctzll(left);
      if (voxel > done)
        vxm_coverage_put(writer, voxel - done, count);
      fold(&bits, f->words, voxel, shift);
      vxm_coverage_put(writer, 1, count_bits(&bits, shift));
      count = (unsigned)vxm_popcount(bits.inside) << shift;
      done = voxel + 1;
    }
  }
  if (done < begin + f->row_length)
    vxm_coverage_put(writer, begin + f->row_length - done, count);
}

void vxm_coverage_put_rows(vxm_coverage_flips *f, size_t rows, vxm_coverage_writer *writer) {
  for (size_t row = 0; row < rows; row++)
    if (f->touched_rows[row / 64] >> row % 64 & 1)
      BY_SHIFT(f, put_row, f, row, writer);
    else
      vxm_coverage_put(writer, f->row_length, 0);
  memset(f->touched_rows, 0, (rows / 64 + 1) * sizeof *f->touched_rows);
}
