/* SPDX-License-Identifier: BSD-3-Clause */
/** The corners of rectangles on the lattice: one vertex for each lattice point, and its neighbours in line.
 */
#ifndef VXM_GRIDIO_CORNERS_H
#define VXM_GRIDIO_CORNERS_H

#include "gridio/rectangles.h"

#define VXM_NO_CORNER UINT32_MAX

/** A lattice point in one word: 21 bits an axis hold 0 to VXM_DIM_MAX; ordered by z, then y, then x. */
static inline uint64_t vxm_point(uint64_t x, uint64_t y, uint64_t z) {
  return z << 42 | y << 21 | x;
}

static inline uint32_t vxm_point_coordinate(uint64_t point, int axis) {
  return (uint32_t)(point >> (21 * axis) & ((1u << 21) - 1));
}

/**
 * Rectangle r (counted over all lists) has the corners 4r to 4r + 3: (u0,v0), (u1,v0), (u1,v1), (u0,v1).
 */
typedef struct vxm_corners {
  vxm_context *context;
  uint32_t *vertex;  /**< of each corner */
  uint64_t *points;  /**< of each vertex, in increasing order */
  uint32_t *next[3]; /**< of each vertex: the next one along x, y, z, or VXM_NO_CORNER */
  size_t vertex_count;
} vxm_corners;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED */
vxm_status vxm_corners_find(vxm_corners *out, const vxm_rectangles *rectangles, const int64_t dims[3],
                            vxm_error *error);
void vxm_corners_destroy(vxm_corners *corners);

#endif
