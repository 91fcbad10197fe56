/* SPDX-License-Identifier: BSD-3-Clause */
/** The edge map of a soup: every undirected edge once, with the sides of faces that run along it. */
#ifndef VXM_MESH_EDGES_H
#define VXM_MESH_EDGES_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * An edge a < b. A side is a pair of successive corners of a face, so a polygon that passes an edge twice
 * counts twice.
 */
typedef struct vxm_edge {
  uint32_t a, b;
  uint32_t count;   /**< sides along the edge, in either direction; at least 1 */
  uint32_t forward; /**< those that run from a to b */
} vxm_edge;

/** No edge: see vxm_edges. */
#define VXM_NO_EDGE UINT32_MAX

/** Edges in increasing order of a, then of b. */
typedef struct vxm_edges {
  vxm_context *context;
  vxm_edge *edges;
  size_t count;
  uint32_t *sides; /**< per corner the place of the edge from it to the next corner of its face, or
                      VXM_NO_EDGE where there is none; NULL if it was not asked for */
  size_t odd;      /**< edges with an odd number of sides; 0 means closed mod 2 */
  size_t open;     /**< with one side */
  size_t crowded;  /**< with more than two */
  size_t against;  /**< with two that run the same way */
} vxm_edges;

/**
 * Builds the edge map.
 *
 * @param[out] out   freed with vxm_edges_destroy; empty after a failure
 * @param vertex_map vertex to take in place of each vertex (as from vxm_weld_exact), or NULL
 *
 * Faces with fewer than three distinct corners (after mapping) take no part, and a side from a vertex to
 * itself is none; neither changes whether a number of sides is odd. Time and scratch memory (8 bytes per
 * corner) are linear in the corners, not in the vertices.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_edges_build(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                           const uint32_t *vertex_map, vxm_error *error);
/** As vxm_edges_build, with `sides`. @return also VXM_ERROR_RANGE beyond 2^32 - 2 edges */
vxm_status vxm_edges_build_sides(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                                 const uint32_t *vertex_map, vxm_error *error);
void vxm_edges_destroy(vxm_edges *edges);

/** Place of the edge between two vertices, in either order, or edges->count; logarithmic time. */
size_t vxm_edges_find(const vxm_edges *edges, uint32_t a, uint32_t b);

/** An odd number of sides: the soup is not closed here. */
static inline bool vxm_edge_is_odd(const vxm_edge *edge) {
  return edge->count & 1;
}

/** Whether a face has at least three distinct corners after mapping. */
static inline bool vxm_face_has_three(const uint32_t *corners, size_t count, const uint32_t *vertex_map) {
  uint32_t first = VXM_NO_VERTEX, second = VXM_NO_VERTEX;
  for (size_t i = 0; i < count; i++) {
    uint32_t v = vertex_map ? vertex_map[corners[i]] : corners[i];
    if (first == VXM_NO_VERTEX)
      first = v;
    else if (v != first) {
      if (second == VXM_NO_VERTEX)
        second = v;
      else if (v != second)
        return true;
    }
  }
  return false;
}

#ifdef __cplusplus
}
#endif
#endif
