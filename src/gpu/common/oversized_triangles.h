/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles that reach so far that products of their differences do not fit the 64 bits of shaders: the CPU
 * does them, in 128 bits. There are few, in odd meshes. */
#ifndef VXM_GPU_COMMON_OVERSIZED_TRIANGLES_H
#define VXM_GPU_COMMON_OVERSIZED_TRIANGLES_H

#include "gpu/common/disjoint_passes.h"
#include "gpu/common/slab.h"

/** Oversized triangles. Start from {.context = ...}. */
typedef struct vxm_oversized {
  vxm_context *context;
  uint32_t *triangles;
  size_t count, capacity;
} vxm_oversized;

/** Oversized triangles of a surface, by their corners. Start from {.context = ...}. */
typedef struct vxm_oversized_surface {
  vxm_context *context;
  uint32_t (*corners)[3];
  size_t count, capacity;
} vxm_oversized_surface;

/** Finds them. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_oversized_find(vxm_oversized *oversized, const vxm_triangle_set *triangles,
                              const vxm_snapped_points *placed, vxm_error *error);
vxm_status vxm_oversized_surface_find(vxm_oversized_surface *oversized, const vxm_surface *surface,
                                      vxm_error *error);
void vxm_oversized_destroy(vxm_oversized *oversized);
void vxm_oversized_surface_destroy(vxm_oversized_surface *oversized);

/** Points for shaders: 32 bits and, where a point does not fit them, a mark as the fourth number. */
void vxm_oversized_narrow(int32_t (*out)[4], const vxm_point *points, size_t count);

/** What the oversized triangles of a pass flip: bits of a slab, in a new block. `count` is 0 and the block
 * NULL if there are none. */
vxm_status vxm_oversized_flips(uint32_t **out, size_t *count, const vxm_oversized *oversized,
                               const vxm_slab_columns *slab, const vxm_parity_union_job *job,
                               const vxm_disjoint_passes *passes, size_t pass, vxm_error *error);
/** Adds the oversized triangles of a surface to a window. */
vxm_status vxm_oversized_surface_add(const vxm_oversized_surface *oversized, const vxm_surface *surface,
                                     const vxm_window *window, vxm_surface_kind kind, vxm_error *error);

#endif
