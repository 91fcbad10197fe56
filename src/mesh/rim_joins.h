/* SPDX-License-Identifier: BSD-3-Clause */
/** How the odd edges at a vertex are joined to rims (mesh/boundary_loops.h). */
#ifndef VXM_MESH_RIM_JOINS_H
#define VXM_MESH_RIM_JOINS_H

#include "mesh/boundary_loops.h"

/** An odd edge. Ends are told apart by where they are, so that loops do not hang on how vertices are
 * numbered.
 */
typedef struct vxm_odd_edge {
  size_t edge;           /**< place in the edge map */
  uint32_t first, other; /**< its ends: the vertex that comes first in space, and the other */
} vxm_odd_edge;

/**
 * Odd edges stand in the order of their first, then of their other ends. Number o has the ends 2 o (at its
 * first vertex) and 2 o + 1 (at the other). Every end is joined with another one at the same vertex.
 */
typedef struct vxm_rim_joins {
  const vxm_soup *soup;
  const vxm_edges *edges;
  vxm_context *context;
  vxm_error error; /**< of the last allocation that failed */
  size_t odd_count;
  vxm_odd_edge *odd;
  size_t *first_end; /**< per vertex: its ends are ends[first_end[v]] to ends[first_end[v + 1] - 1] */
  size_t *ends;
  size_t *partner; /**< per end */
  uint64_t *sides; /**< sorted, unique: vertex << 32 | neighbour, for vertices with more than two odd edges */
  size_t side_count;
  size_t *fan; /**< per side: a union-find forest over the sides of a vertex */
} vxm_rim_joins;

static inline uint32_t vxm_rim_vertex_of(const vxm_rim_joins *b, size_t end) {
  return end % 2 ? b->odd[end / 2].other : b->odd[end / 2].first;
}

/**
 * Joins the ends, which are listed, at each vertex.
 *
 * @param at    per vertex: 1 = its ends are joined anew, 0 = they stay as they are; NULL = all are joined
 * @param owner per edge: only ends of edges with the same owner are joined, of which a vertex has an even
 *              number; NULL = any are
 * @return false: see b->error
 */
bool vxm_rim_joins_make(vxm_rim_joins *b, const uint8_t *at, const uint32_t *owner);
/** Walks along the odd edges as they are joined; the loops have room for all. @return false: see b->error */
bool vxm_rim_joins_walk(vxm_rim_joins *b, vxm_boundary_loops *loops);

#endif
