/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A range of slices of a grid whose bits may run along any axis.
 *
 * A dense grid has its bits along x, rows along y and slices along z. Files have other orders: .binvox has
 * bits along y, rows along z and slices along x. A window in the file's own layout can be computed and
 * written slice by slice, without the grid that it belongs to ever being held.
 */
#ifndef VXM_GRID_WINDOW_H
#define VXM_GRID_WINDOW_H

#include "grid/bitgrid.h"

#include <string.h>

/** Which axis of the voxel space (0 = x, 1 = y, 2 = z) bits, rows and slices run along. */
typedef struct vxm_layout {
  int fast, middle, slow;
} vxm_layout;

/** Bits along x, rows along y, slices along z: the layout of vxm_grid. */
#define VXM_LAYOUT_GRID \
  { 0, 1, 2 }

static inline bool vxm_layouts_equal(vxm_layout a, vxm_layout b) {
  return a.fast == b.fast && a.middle == b.middle && a.slow == b.slow;
}

/** Whether it is that of a grid in memory. */
static inline bool vxm_layout_is_grid(vxm_layout layout) {
  return vxm_layouts_equal(layout, (vxm_layout)VXM_LAYOUT_GRID);
}

/** Slices begin..end-1 of a voxel space. Bits beyond the end of a row are zero: every writer keeps that. */
typedef struct vxm_window {
  vxm_layout layout;
  int64_t fast_dim, middle_dim, slow_dim; /**< of the whole space */
  int64_t begin, end;                     /**< slices, 0 <= begin <= end <= slow_dim */
  size_t row_words;                       /**< (fast_dim + 63) / 64 */
  size_t slice_words;                     /**< from one slice to the next: row_words * middle_dim, or more */
  uint64_t *words;                        /**< of the rows; belong to the caller */
} vxm_window;

/** The window of slices begin..end-1 with words still to be given. */
static inline vxm_window vxm_window_of(const vxm_space *space, vxm_layout layout, int64_t begin,
                                       int64_t end) {
  vxm_window window = {.layout = layout,
                       .fast_dim = space->dims[layout.fast],
                       .middle_dim = space->dims[layout.middle],
                       .slow_dim = space->dims[layout.slow],
                       .begin = begin,
                       .end = end};
  window.row_words = ((size_t)window.fast_dim + 63) / 64;
  window.slice_words = window.row_words * (size_t)window.middle_dim;
  return window;
}

/** All of a grid as a window; the words are the grid's. */
static inline vxm_window vxm_window_of_grid(const vxm_grid *grid) {
  vxm_window window = vxm_window_of(&grid->space, (vxm_layout)VXM_LAYOUT_GRID, 0, grid->space.dims[2]);
  window.words = grid->words;
  return window;
}

/** Row `middle` of slice `slow`, a number of the whole space from window->begin on. */
static inline uint64_t *vxm_window_row(const vxm_window *window, int64_t middle, int64_t slow) {
  return window->words + (size_t)(slow - window->begin) * window->slice_words +
         (size_t)middle * window->row_words;
}

/** What the words of its slices take. */
static inline size_t vxm_window_bytes(const vxm_window *window) {
  return window->slice_words * (size_t)(window->end - window->begin) * sizeof(uint64_t);
}

/** Empties the slices begin..end-1 of the whole space, which the window has. */
static inline void vxm_window_clear(const vxm_window *window, int64_t begin, int64_t end) {
  for (int64_t k = begin; k < end; k++)
    memset(vxm_window_row(window, 0, k), 0,
           window->row_words * (size_t)window->middle_dim * sizeof *window->words);
}

/** The valid bits of the last word of a row. */
static inline uint64_t vxm_window_tail_mask(const vxm_window *window) {
  unsigned rest = (unsigned)(window->fast_dim % 64);
  return rest ? vxm_low_bits(rest) : ~UINT64_C(0);
}

#endif
