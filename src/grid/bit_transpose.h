/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The grid cut across x. Rows of the grid run along x; .binvox and .npy run along y or z and vary x slowest.
 * Between them stand the planes of up to 64 consecutive x, which one word column of the grid holds, made by
 * transposing 64 x 64 bits at a time.
 */
#ifndef VXM_GRID_BIT_TRANSPOSE_H
#define VXM_GRID_BIT_TRANSPOSE_H

#include "grid/window.h"

/** The layouts of planes: row k of a plane runs along y, or row j along z. */
#define VXM_PLANE_Y_FAST \
  { 1, 2, 0 }
#define VXM_PLANE_Z_FAST \
  { 2, 1, 0 }

/** Bits beyond `length` in the last word of a row are zero. */
typedef struct vxm_bit_transpose {
  vxm_context *context;
  vxm_layout layout;  /**< one of the two */
  size_t count;       /**< planes: the smaller of 64 and dims[0] */
  size_t rows;        /**< rows of a plane */
  size_t length;      /**< bits of a row */
  size_t row_words;   /**< (length + 63) / 64 */
  size_t plane_words; /**< words from one plane to the next; not a power of two, which would make all planes
                           share one set of the cache */
  uint64_t *words;
} vxm_bit_transpose;

vxm_status vxm_bit_transpose_create(vxm_bit_transpose *out, vxm_context *context, const vxm_space *space,
                                    vxm_layout layout, vxm_error *error);
/** What vxm_bit_transpose_create allocates. */
uint64_t vxm_bit_transpose_bytes(const vxm_space *space, vxm_layout layout);
void vxm_bit_transpose_destroy(vxm_bit_transpose *planes);

static inline uint64_t *vxm_plane_row(const vxm_bit_transpose *planes, size_t plane, size_t row) {
  return planes->words + plane * planes->plane_words + row * planes->row_words;
}

/** Planes that word column `word` of the grid holds: 64, or fewer in the last. */
static inline size_t vxm_bit_transpose_in(const vxm_grid *grid, size_t word) {
  size_t left = (size_t)grid->space.dims[0] - word * 64;
  return left < 64 ? left : 64;
}

/** Word column `word` of the grid, which the planes hold, as a window. */
vxm_window vxm_bit_transpose_window(const vxm_bit_transpose *planes, const vxm_grid *grid, size_t word);

/** A word made of a row of the grid, such as the row's own word or its exposed faces. */
typedef uint64_t (*vxm_row_word_fn)(const uint64_t *row, size_t word, size_t row_words);

/** Fills the planes from word column `word` of the grid, seen through `load` (NULL = the words as they are).
 */
void vxm_bit_transpose_gather(vxm_bit_transpose *planes, const vxm_grid *grid, size_t word,
                              vxm_row_word_fn load);
/** Writes the planes to word column `word` of the grid. */
void vxm_bit_transpose_scatter(const vxm_bit_transpose *planes, vxm_grid *grid, size_t word);
/** Clears all planes. */
void vxm_bit_transpose_clear(vxm_bit_transpose *planes);

#endif
