/* SPDX-License-Identifier: BSD-3-Clause */
/** The edge map of a soup: every undirected edge once, with the sides of faces that run along it. */
#ifndef VXM_MESH_EDGES_H
#define VXM_MESH_EDGES_H

#include "mesh/side_table.h"

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
  uint32_t *sides;    /**< per corner the place of the edge from it to the next corner of its face, or
                         VXM_NO_EDGE where there is none; NULL if it was not asked for */
  uint32_t *adjacent; /**< per corner the face across that side (mesh/face_adjacency.h), or NULL: see
                       vxm_edges_build_pairs */
  size_t odd;         /**< edges with an odd number of sides; 0 means closed mod 2 */
  size_t open;        /**< with one side */
  size_t crowded;     /**< with more than two */
  size_t against;     /**< with two that run the same way */
} vxm_edges;

/**
 * Builds the edge map.
 *
 * @param[out] out   freed with vxm_edges_destroy; empty after a failure
 * @param vertex_map vertex to take in place of each vertex (as from vxm_weld_exact), or NULL
 *
 * Faces with fewer than three distinct corners (after mapping) take no part, and a side from a vertex to
 * itself is none; neither changes whether a number of sides is odd. Time and scratch memory are linear in
 * corners and vertices (mesh/side_table.h).
 *
 * @return VXM_OK; VXM_ERROR_RANGE beyond 2^32 - 2 corners; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_edges_build(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                           const uint32_t *vertex_map, vxm_error *error);
/** As vxm_edges_build, with `sides`. */
vxm_status vxm_edges_build_sides(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                                 const uint32_t *vertex_map, vxm_error *error);
/**
 * Where each edge has two sides that run opposite ways, as in most meshes that are closed, only counts them,
 * and tells which face lies `adjacent` each side: there are no `edges` and no `sides`, which take more than
 * half of the time. Else as vxm_edges_build_sides.
 */
vxm_status vxm_edges_build_pairs(vxm_edges *out, vxm_context *context, const vxm_soup *soup,
                                 vxm_error *error);
void vxm_edges_destroy(vxm_edges *edges);

/** The two vertices of an edge in one number, whatever their order; of two that differ never 0. */
static inline uint64_t vxm_edge_key(uint32_t a, uint32_t b) {
  return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/** Place of the edge between two vertices, in either order, or edges->count; logarithmic time. */
size_t vxm_edges_find(const vxm_edges *edges, uint32_t a, uint32_t b);

/** An odd number of sides: the soup is not closed here. */
static inline bool vxm_edge_is_odd(const vxm_edge *edge) {
  return edge->count & 1;
}

#ifdef __cplusplus
}
#endif
#endif
