/* SPDX-License-Identifier: BSD-3-Clause */
/** The shell of a solid that is made window after window: each needs a slice of the solid on both sides. */
#ifndef VXM_VOXEL_SURFACE_SHELL_WINDOW_H
#define VXM_VOXEL_SURFACE_SHELL_WINDOW_H

#include "grid/shell.h"

/** The solid of the present window, with the slices before and behind it. */
typedef struct vxm_shell_window {
  uint64_t *words;
  size_t capacity;    /**< in words */
  int64_t begin, end; /**< slices of the solid that are there */
} vxm_shell_window;

/** Replaces the words of a window by the solid. */
typedef vxm_status (*vxm_fill_fn)(const vxm_window *window, void *payload, vxm_error *error);

/** Forgets the solid of another grid. */
static inline void vxm_shell_window_begin(vxm_shell_window *shelling) {
  shelling->begin = shelling->end = 0;
}

/**
 * Replaces the words of a window by the shell. Windows come in order, each where the last one ended, so that
 * every slice of the solid is made once.
 *
 * @return what `fill` does; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_shell_window_fill(vxm_shell_window *shelling, const vxm_window *window,
                                 vxm_adjacency adjacency, vxm_fill_fn fill, void *payload,
                                 vxm_context *context, vxm_error *error);

void vxm_shell_window_destroy(vxm_shell_window *shelling, vxm_context *context);

#endif
