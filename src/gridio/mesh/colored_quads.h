/* SPDX-License-Identifier: BSD-3-Clause */
/** The exposed faces of voxels, merged into rectangles where they look alike. */
#ifndef VXM_GRIDIO_MESH_COLORED_QUADS_H
#define VXM_GRIDIO_MESH_COLORED_QUADS_H

#include "gridio/common/values.h"

/** A rectangle with lattice coordinates as in a vxm_greedy_quad. */
typedef struct vxm_colored_quad {
  uint32_t key; /**< 1 of bits, the label, or 2^24 + the colour as 0xrrggbb */
  uint32_t level, u0, v0, u1, v1;
  uint32_t axis;
} vxm_colored_quad;

typedef struct vxm_colored_quads {
  vxm_context *context;
  vxm_colored_quad *items;
  size_t count, capacity;
} vxm_colored_quads;

/**
 * Of bits and labels, which are 0 to 65535, or of colours. Rectangles of a label follow each other, the
 * labels in order.
 *
 * @return VXM_OK; VXM_ERROR_RANGE for more than 2^30 rectangles; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
vxm_status vxm_colored_quads_make(vxm_colored_quads *out, const vxm_field *field, vxm_error *error);
void vxm_colored_quads_destroy(vxm_colored_quads *quads);

#endif
