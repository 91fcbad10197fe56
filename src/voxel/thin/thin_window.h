/* SPDX-License-Identifier: BSD-3-Clause */
/** A solid with thin parts kept, made window after window. */
#ifndef VXM_VOXEL_THIN_THIN_WINDOW_H
#define VXM_VOXEL_THIN_THIN_WINDOW_H

#include "grid/slice_buffer.h"
#include "voxel/thin/thin.h"

/** Start from zeros with the context of `thin`. */
typedef struct vxm_thin_window {
  vxm_thin_adder thin;
  vxm_slice_buffer solid; /**< without what is added; not used where a window is the whole space */
  uint64_t *words;        /**< some slices of it, to which voxels are added */
  size_t capacity;        /**< of `words` */
  uint64_t *before;       /**< slices that have been replaced */
  size_t before_capacity;
} vxm_thin_window;

/** What belongs to the grid that is made. */
typedef struct vxm_thin_grid {
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  int separating;      /**< 6 or 26, as for vxm_thin_add */
  uint8_t *confidence; /**< as for vxm_thin_add */
  vxm_fill_fn fill;    /**< the solid without what is added */
  void *payload;
} vxm_thin_grid;

/** Forgets another grid. */
static inline void vxm_thin_window_begin(vxm_thin_window *window) {
  vxm_thin_begin(&window->thin);
  vxm_slice_buffer_begin(&window->solid);
}

/**
 * Replaces the words of a window by the solid with what holds thin parts together. Windows come in order,
 * each where the last one ended.
 *
 * @return what `fill` and vxm_thin_add do
 */
vxm_status vxm_thin_window_fill(vxm_thin_window *thin, const vxm_window *window, const vxm_thin_grid *grid,
                                vxm_error *error);

void vxm_thin_window_destroy(vxm_thin_window *window);

#endif
