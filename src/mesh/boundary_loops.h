/* SPDX-License-Identifier: BSD-3-Clause */
/** The loops that the odd edges of a soup form: the rims of its holes and sheets. */
#ifndef VXM_MESH_BOUNDARY_LOOPS_H
#define VXM_MESH_BOUNDARY_LOOPS_H

#include "mesh/edges.h"

/** A component whose caps, over all of its loops, would have at least this part of its area is a sheet rather
 * than a body with holes: they would only cover it a second time. */
#define VXM_SHEET_PART 0.75

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Closed walks that together pass every odd edge once. Step s goes along edge[s] (a place in the edge map)
 * from vertex[s] to vertex[s + 1], the last step of a loop back to its first vertex. A walk may pass a vertex
 * twice.
 *
 * Every face has two sides at each of its corners, so a vertex has an even number of odd edges and the walks
 * always close. Where a vertex has more than two, the rim of a hole leads from the end of one fan of faces to
 * the beginning of the next, never back along its own fan: odd edges of different fans are joined, the
 * smallest angle first. So the slits along T-junctions become loops of their own, and panels that share
 * corners are not taken for holes. But edges that do not lie along each other are joined only if the faces
 * run along both one way, as they do around the hole that a face has left, where there are such: then what
 * closes the loop can be wound as the faces are. Of four edges that meet at equal angles those are joined
 * that leave the straightest way to the two others, and then those that lie along each other but along which
 * the faces run one way. What is still equal is decided by where vertices lie, and so are the order of loops
 * and where each begins: nothing hangs on how vertices and faces are numbered, but where several lie at one
 * place.
 *
 * Where a walk would pass a vertex twice because bodies touch there, each body has its rim by itself
 * (mesh/touching_bodies.h).
 */
typedef struct vxm_boundary_loops {
  vxm_context *context;
  size_t count;
  size_t *begin;    /**< loop l has steps begin[l] to begin[l + 1] - 1 */
  size_t *edge;     /**< of every step */
  uint32_t *vertex; /**< of every step */
} vxm_boundary_loops;

/**
 * Finds the loops.
 *
 * @param[out] out freed with vxm_boundary_loops_destroy; empty after a failure
 * @param edges    of the same soup, without a vertex map
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Linear time, but for sorting the odd edges, and those at vertices with more than two odd ones. At a vertex
 * with more than 32 of them only those that are near in direction are compared. Where bodies touch, the loops
 * there are closed by caps for a try.
 */
vxm_status vxm_boundary_loops_build(vxm_boundary_loops *out, const vxm_soup *soup, const vxm_edges *edges,
                                    vxm_error *error);
void vxm_boundary_loops_destroy(vxm_boundary_loops *loops);

#ifdef __cplusplus
}
#endif
#endif
