/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons into triangles, for formats that have nothing else. */
#ifndef VXM_MESHIO_TRIANGULATE_H
#define VXM_MESHIO_TRIANGULATE_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Room for the largest polygon met so far. */
typedef struct vxm_triangulator {
  vxm_context *context;
  double *plane;            /**< two coordinates for each corner */
  uint32_t *before, *after; /**< the ring of corners left */
  uint32_t *triangles;      /**< three corners each */
  size_t capacity;
  size_t tests_left; /**< of corners against ears, for all polygons together */
} vxm_triangulator;

void vxm_triangulator_open(vxm_triangulator *tri, vxm_context *context);
void vxm_triangulator_close(vxm_triangulator *tri);

/**
 * Splits a polygon of n >= 3 corners into n - 2 triangles by clipping ears, seen along the axis on which its
 * vector area is largest. A planar simple polygon is covered exactly; others get as many triangles, some of
 * which may overlap. What withstands becomes a fan, and so does what is left when all polygons together have
 * used up a budget of work; from there on each takes linear time.
 *
 * @param[out] triangles 3 (n - 2) vertex numbers, valid until the next call
 */
vxm_status vxm_triangulate(vxm_triangulator *tri, const double *positions, const uint32_t *corners, size_t n,
                           const uint32_t **triangles, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif
