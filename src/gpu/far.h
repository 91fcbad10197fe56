/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles that reach so far that products of their differences do not fit the 64 bits of shaders: the CPU
 * does them, in 128 bits. There are few, in odd meshes. */
#ifndef VXM_GPU_FAR_H
#define VXM_GPU_FAR_H

#include "gpu/passes.h"
#include "gpu/tile.h"

/** Facets that are far. Start from {.context = ...}. */
typedef struct vxm_far {
  vxm_context *context;
  uint32_t *facets;
  size_t count, capacity;
} vxm_far;

/** Triangles of a surface that are far, by their corners. Start from {.context = ...}. */
typedef struct vxm_far_surface {
  vxm_context *context;
  uint32_t (*corners)[3];
  size_t count, capacity;
} vxm_far_surface;

/** Finds them. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_far_find(vxm_far *far, const vxm_facets *facets, const vxm_placed *placed, vxm_error *error);
vxm_status vxm_far_surface_find(vxm_far_surface *far, const vxm_surface *surface, vxm_error *error);
void vxm_far_destroy(vxm_far *far);
void vxm_far_surface_destroy(vxm_far_surface *far);

/** Points for shaders: 32 bits and, where a point does not fit them, a mark as the fourth number. */
void vxm_far_narrow(int32_t (*out)[4], const vxm_point *points, size_t count);

/** What the far facets of a pass flip: bits of a tile, in a new block. `count` is 0 and the block NULL if
 * there are none. */
vxm_status vxm_far_flips(uint32_t **out, size_t *count, const vxm_far *far, const vxm_tile_columns *tile,
                         const vxm_unite_job *job, const vxm_passes *passes, size_t pass, vxm_error *error);
/** Adds the far triangles of a surface to a window. */
vxm_status vxm_far_surface_add(const vxm_far_surface *far, const vxm_surface *surface,
                               const vxm_window *window, vxm_surface_kind kind, vxm_error *error);

#endif
