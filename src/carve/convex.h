/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Convex bodies that faces sweep, cut out of a stock: prisms, where a triangle moves without turning, and
 * tetrahedra, where its corners move each its own way.
 *
 * All is in whole lattice steps and exact (voxel/lattice/lattice.h). The centres of voxels are moved by
 * (e, e^2, e^3) with e infinitely small, as they are for the solid, so that none lies on a plane: bodies side
 * by side leave nothing between them, and flat ones have no voxels.
 */
#ifndef VXM_CARVE_CONVEX_H
#define VXM_CARVE_CONVEX_H

#include "carve/stock.h"
#include "voxel/lattice/lattice.h"

/** Bits of the differences of a body's corners along an axis, at most: products of three of them, summed,
 * stay within 63. */
enum { VXM_CONVEX_BITS = 20 };

/** Voxels first..last along each axis. */
typedef struct vxm_voxel_box {
  int64_t first[3], last[3];
} vxm_voxel_box;

/** The voxels whose centres lie in a box of lattice coordinates, its faces included, and in a space. */
static inline vxm_voxel_box vxm_voxel_box_of(const vxm_lattice *lattice, const int64_t low[3],
                                             const int64_t high[3]) {
  vxm_voxel_box box;
  const int64_t half = lattice->unit / 2;
  for (int a = 0; a < 3; a++) {
    box.first[a] = vxm_max((low[a] - half + lattice->unit - 1) >> lattice->bits, 0);
    box.last[a] = vxm_min((high[a] - half) >> lattice->bits, lattice->space.dims[a] - 1);
  }
  return box;
}

static inline bool vxm_voxel_box_is_empty(const vxm_voxel_box *box) {
  return (box->first[0] > box->last[0]) | (box->first[1] > box->last[1]) | (box->first[2] > box->last[2]);
}

/** Cuts what a triangle sweeps on a straight path. @param box that has all of it */
void vxm_convex_cut_prism(vxm_stock *stock, const vxm_lattice *lattice, const vxm_point corners[3],
                          const int64_t motion[3], const vxm_voxel_box *box);
/** Cuts a tetrahedron. @param box that has all of it */
void vxm_convex_cut_tetrahedron(vxm_stock *stock, const vxm_lattice *lattice, const vxm_point corners[4],
                                const vxm_voxel_box *box);

#endif
