/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Where lines run through a part, along its shortest side, so that what lies in itself is met: some evenly
 * spaced and some where the part has its points.
 *
 * Where they run hangs on where points are alone, and not on how points are numbered; and a part that is
 * mirrored, or turned by right angles, has its lines mirrored or turned.
 */
#ifndef VXM_VOXEL_WINDING_PROBE_LINES_H
#define VXM_VOXEL_WINDING_PROBE_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
  VXM_PROBE_EVEN = 12,                 /**< along each axis: evenly spaced places at most, */
  VXM_PROBE_MOST = 2 * VXM_PROBE_EVEN, /**< and as many again where most points are */
  VXM_PROBE_CELLS = 251                /**< of a part's width, between which places lie, at most */
};

/** Where planes across an axis lie; lines are where planes across two axes meet. */
typedef struct vxm_probe_places {
  double low, cells_per_unit;
  int cells, count;
  double at[VXM_PROBE_MOST];      /**< in order */
  double width[VXM_PROBE_MOST];   /**< how much of the axis is nearer to it than to the others, in cells */
  uint8_t below[VXM_PROBE_CELLS]; /**< of each cell: the places at its lower end or before */
} vxm_probe_places;

/** How many places lie before a point along x, y and z, in the bytes of a number from the lowest on. */
typedef uint32_t vxm_probe_cell;

/** The same along one axis. */
static inline int vxm_probe_along(vxm_probe_cell cell, int axis) {
  return (int)(cell >> 8 * axis & 0xff);
}

/**
 * Chooses the axis of the lines, and along the two others up to `even` evenly spaced places, an even number,
 * and as many where most points are; and tells between which of them each point lies.
 *
 * @param[out] along  the axis along which the points have the least extent, the last one of several
 * @param[out] places along each axis: none along that of the lines
 * @return false if the points have no extent along an axis, or none that could be told
 */
bool vxm_probe_lines_lay(int *along, vxm_probe_places places[3], vxm_probe_cell *cells,
                         const double (*points)[3], size_t count, int even);

/** How many places lie before a coordinate. Whatever is compared with places goes through this, so that
 * triangles that share an edge agree. */
static inline uint8_t vxm_probe_below(const vxm_probe_places *p, double at) {
  double cell = (at - p->low) * p->cells_per_unit;
  return p->below[cell > 0 ? cell < p->cells ? (int)cell : p->cells - 1 : 0];
}

/** Tells by a bit in each byte along which axes places lie between three points. */
static inline uint32_t vxm_probe_between(vxm_probe_cell a, vxm_probe_cell b, vxm_probe_cell c) {
  enum { LESS = 0x1f1f1f, CARRY = 0x202020 }; /* numbers are less than 32 */
  return (((a ^ b) | (a ^ c)) + LESS) & CARRY;
}

#endif
