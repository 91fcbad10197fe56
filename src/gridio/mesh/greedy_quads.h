/* SPDX-License-Identifier: BSD-3-Clause */
/** The exposed faces of a grid, merged into rectangles. */
#ifndef VXM_GRIDIO_MESH_GREEDY_QUADS_H
#define VXM_GRIDIO_MESH_GREEDY_QUADS_H

#include "grid/bitgrid.h"

/** Lattice coordinates: (u, v) are (y, z) on an x face, (x, z) on a y face, (x, y) on a z face. */
typedef struct vxm_greedy_quad {
  uint32_t level; /**< 2 * the coordinate along the axis, + 1 if it faces the positive direction */
  uint32_t u0, v0, u1, v1;
} vxm_greedy_quad;

/** Those of some layers of one axis; the order of the lists and in them does not depend on threads. */
typedef struct vxm_greedy_quad_list {
  int axis;
  size_t count, capacity;
  vxm_greedy_quad *items;
} vxm_greedy_quad_list;

typedef struct vxm_greedy_quads {
  vxm_context *context;
  vxm_greedy_quad_list *lists;
  size_t list_count;
  size_t count; /**< in all lists */
} vxm_greedy_quads;

/**
 * Finds all exposed faces; each lies in exactly one rectangle.
 *
 * @return VXM_OK; VXM_ERROR_RANGE for more than 2^30 rectangles; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_greedy_quads_find(vxm_greedy_quads *out, const vxm_grid *grid, vxm_error *error);
void vxm_greedy_quads_destroy(vxm_greedy_quads *quads);

#endif
