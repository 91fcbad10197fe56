/* SPDX-License-Identifier: BSD-3-Clause */
/** The corners of rectangles on the lattice: one vertex for each lattice point, and its neighbours in line.
 */
#ifndef VXM_GRIDIO_MESH_QUAD_VERTICES_H
#define VXM_GRIDIO_MESH_QUAD_VERTICES_H

#include "gridio/mesh/greedy_quads.h"

#define VXM_NO_CORNER UINT32_MAX

/** A lattice point in one word: 21 bits an axis hold 0 to VXM_DIM_MAX; ordered by z, then y, then x. */
static inline uint64_t vxm_quad_point(uint64_t x, uint64_t y, uint64_t z) {
  return z << 42 | y << 21 | x;
}

static inline uint32_t vxm_quad_point_coordinate(uint64_t point, int axis) {
  return (uint32_t)(point >> (21 * axis) & ((1u << 21) - 1));
}

/**
 * Rectangle r (counted over all lists) has the corners 4r to 4r + 3: (u0,v0), (u1,v0), (u1,v1), (u0,v1).
 */
typedef struct vxm_quad_vertices {
  vxm_context *context;
  uint32_t *vertex;  /**< of each corner */
  uint64_t *points;  /**< of each vertex, in increasing order */
  uint32_t *next[3]; /**< of each vertex: the next one along x, y, z, or VXM_NO_CORNER */
  size_t vertex_count;
} vxm_quad_vertices;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED */
vxm_status vxm_quad_vertices_find(vxm_quad_vertices *out, const vxm_greedy_quads *quads,
                                  const int64_t dims[3], vxm_error *error);
void vxm_quad_vertices_destroy(vxm_quad_vertices *corners);

#endif
