/* SPDX-License-Identifier: BSD-3-Clause */
/** Which sides of a soup's faces are joined, and the fans of faces that this makes around its vertices. */
#ifndef VXM_REPAIR_MANIFOLD_HALFEDGE_PAIRING_H
#define VXM_REPAIR_MANIFOLD_HALFEDGE_PAIRING_H

#include "repair/manifold/radial_sort.h"

/**
 * A side of a face is named by the corner of the soup it starts from. Each side is joined with one other side
 * that runs the other way, or with none. The faces around a vertex that follow each other over joined sides
 * are a fan; it is closed, or open with a first and a last face. Where a vertex has several fans, each stands
 * for a vertex of a manifold mesh: two sides between the same two fans are always those of one joined pair.
 */
typedef struct vxm_halfedge_pairing {
  const vxm_soup *soup;
  double scale;      /**< a power of two that brings the soup to about unit size */
  uint32_t *face;    /**< per corner */
  uint32_t *partner; /**< per side: the side that it is joined with, or VXM_NO_SIDE */
  uint32_t *fan;     /**< per corner: its fan, less than fan_count */
  uint32_t *start;   /**< per fan: the corner that it starts with; of a closed fan any */
  uint32_t fan_count;
} vxm_halfedge_pairing;

/**
 * Joins the sides along each edge and resolves what that leaves ambiguous. Along an edge with two sides there
 * is no choice; along others see repair/manifold/radial_sort.h, where the faces that such plain edges connect
 * are a group. Sides that run the same way are not joined.
 *
 * @param[out] out freed with vxm_halfedge_pairing_destroy; empty after a failure
 * @param soup     lives as long as `out`; faces have at least three corners, all different
 * @return VXM_OK; VXM_ERROR_ARGUMENT with the face that has not; VXM_ERROR_RANGE beyond 2^30 corners;
 *         VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_halfedge_pairing_build(vxm_halfedge_pairing *out, const vxm_soup *soup, vxm_error *error);
void vxm_halfedge_pairing_destroy(vxm_halfedge_pairing *pairing);

/**
 * Joins sides without a partner that run in opposite directions between bit-identical positions, unless a
 * vertex would then meet another one, or itself, along two edges, or twice in a face. Fans that become one
 * take one of their numbers; the other is of no fan after. Afterwards nothing is left that could be joined
 * so.
 *
 * @param[out] stitched edges that were joined
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED; then the pairing is of no
 * use
 */
vxm_status vxm_halfedge_pairing_stitch(vxm_halfedge_pairing *pairing, int64_t *stitched, vxm_error *error);

static inline uint32_t vxm_halfedge_pairing_next(const vxm_halfedge_pairing *pairing, uint32_t corner) {
  const uint64_t *bounds = pairing->soup->offsets + pairing->face[corner];
  return corner + 1 < bounds[1] ? corner + 1 : (uint32_t)bounds[0];
}

static inline uint32_t vxm_halfedge_pairing_previous(const vxm_halfedge_pairing *pairing, uint32_t corner) {
  const uint64_t *bounds = pairing->soup->offsets + pairing->face[corner];
  return (uint32_t)(corner > bounds[0] ? corner : bounds[1]) - 1;
}

/** The corner of the next face of the fan, across the side that starts here, or VXM_NO_SIDE. */
static inline uint32_t vxm_halfedge_pairing_after(const vxm_halfedge_pairing *pairing, uint32_t corner) {
  uint32_t partner = pairing->partner[corner];
  return partner == VXM_NO_SIDE ? VXM_NO_SIDE : vxm_halfedge_pairing_next(pairing, partner);
}

/** The corner of the face before, across the side that ends here, or VXM_NO_SIDE. */
static inline uint32_t vxm_halfedge_pairing_before(const vxm_halfedge_pairing *pairing, uint32_t corner) {
  return pairing->partner[vxm_halfedge_pairing_previous(pairing, corner)];
}

static inline void vxm_halfedge_pairing_join(vxm_halfedge_pairing *pairing, uint32_t p, uint32_t q) {
  pairing->partner[p] = q;
  pairing->partner[q] = p;
}

#endif
