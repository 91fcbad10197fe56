/* SPDX-License-Identifier: BSD-3-Clause */
/** Surfaces drawn into windows. */
#ifndef TEST_VOXEL_SURFACES_H
#define TEST_VOXEL_SURFACES_H

#include "shapes.h"

#include "voxel/surface/surface.h"

#include <stdlib.h>

static const vxm_layout layouts[6] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
static inline vxm_space unit_space(int64_t nx, int64_t ny, int64_t nz) {
  return (vxm_space){{nx, ny, nz}, {0, 0, 0}, {1, 1, 1}};
}

static inline vxm_window window_make(const vxm_space *space, vxm_layout layout, int64_t begin, int64_t end) {
  vxm_window window = vxm_window_of(space, layout, begin, end);
  window.words = malloc((size_t)(end - begin) * window.slice_words * sizeof *window.words + 1);
  return window;
}

static inline bool window_get(const vxm_window *window, const int64_t voxel[3]) {
  int64_t f = voxel[window->layout.fast], m = voxel[window->layout.middle], s = voxel[window->layout.slow];
  return vxm_window_row(window, m, s)[f / 64] >> (f % 64) & 1;
}

static inline void draw(const vxm_surface *surface, const vxm_window *window, vxm_surface_kind kind,
                        bool is_fresh) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_surface_add(surface, window, kind, is_fresh, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

static inline vxm_surface *surface_of(const vxm_soup *soup, const vxm_lattice *lattice,
                                      const double *transform) {
  vxm_surface *surface;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_surface_create(&surface, soup, lattice, transform, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return surface;
}

#endif
