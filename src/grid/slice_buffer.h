/* SPDX-License-Identifier: BSD-3-Clause */
/** Slices around the windows of a grid that is made window after window: what looks at neighbours needs some
 * before and behind each. */
#ifndef VXM_GRID_SLICE_BUFFER_H
#define VXM_GRID_SLICE_BUFFER_H

#include "grid/window.h"

/** The slices of the present window, with those around it. Start from zeros. */
typedef struct vxm_slice_buffer {
  uint64_t *words;
  size_t capacity;    /**< in words */
  int64_t begin, end; /**< slices that are there */
} vxm_slice_buffer;

/** Replaces the words of a window. */
typedef vxm_status (*vxm_fill_fn)(const vxm_window *window, void *payload, vxm_error *error);

/** Forgets the slices of another grid. */
static inline void vxm_slice_buffer_begin(vxm_slice_buffer *buffer) {
  buffer->begin = buffer->end = 0;
}

/**
 * Fills a window with `margin` slices around it, where the space has such. Windows come in order, each where
 * the last one ended, so that every slice is filled once.
 *
 * @param[out] out a window over the buffer's words, which must be kept as they are
 * @return what `fill` does; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_slice_buffer_fill(vxm_slice_buffer *buffer, vxm_window *out, const vxm_window *window,
                                 int64_t margin, vxm_fill_fn fill, void *payload, vxm_context *context,
                                 vxm_error *error);

void vxm_slice_buffer_destroy(vxm_slice_buffer *buffer, vxm_context *context);

#endif
