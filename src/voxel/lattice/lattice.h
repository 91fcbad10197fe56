/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The integer lattice: every coordinate is snapped to it once, and everything after that is exact.
 *
 * A voxel is `unit` = 2^bits lattice steps wide, so the centre of voxel i lies at i * unit + unit / 2. Points
 * exactly on a centre are told apart by one symbolic perturbation (Edelsbrunner & Muecke 1990): all centres
 * are moved by (e, e^2, e^3) with e infinitely small and positive. Since every axis and every method asks
 * about the same moved points, and these never lie on a triangle or in line with an edge, their answers agree
 * on any closed surface.
 */
#ifndef VXM_VOXEL_LATTICE_LATTICE_H
#define VXM_VOXEL_LATTICE_LATTICE_H

#include "grid/bitgrid.h"
#include "voxel/lattice/rules.h"

typedef struct vxm_lattice {
  int bits;
  int64_t unit;
  vxm_space space;
} vxm_lattice;

/** A lattice point. */
typedef struct vxm_point {
  int64_t at[3];
} vxm_point;

/** Coordinates stay below this, so that products of three differences fit 128 bits. */
#define VXM_LATTICE_MAX (INT64_C(1) << 40)

/** Differences of coordinates up to this keep products of three within 63 bits
 * (voxel/parity/raster_body.inc). */
#define VXM_LATTICE_NARROW (INT64_C(1) << 20)

/** Chooses the steps per voxel: as fine as 64-bit products of three differences inside the grid allow, 8 to
 * 16 bits. */
vxm_lattice vxm_lattice_of(const vxm_space *space);

/** Snaps one position; false, and nothing stored, if it is not finite or lies too far outside the grid. */
bool vxm_lattice_place(const vxm_lattice *lattice, const double position[3], vxm_point *point);

/** Moves a position by a 3 x 4 matrix, row after row. */
static inline void vxm_transform_position(const double transform[12], const double p[3], double out[3]) {
  for (int a = 0; a < 3; a++) {
    const double *row = transform + (ptrdiff_t)4 * a;
    out[a] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
  }
}

/** Fails for a vertex of a mesh that has no place on the lattice. */
vxm_status vxm_lattice_refuse(uint32_t vertex, const double position[3], vxm_error *error);

/** First voxel whose centre is at or beyond a lattice coordinate. */
static inline int64_t vxm_lattice_first(const vxm_lattice *lattice, int64_t coordinate) {
  return vxm_first_centre_64(coordinate, lattice->unit, lattice->bits);
}

/** Last voxel whose centre is at or before a lattice coordinate. */
static inline int64_t vxm_lattice_last(const vxm_lattice *lattice, int64_t coordinate) {
  return (coordinate - lattice->unit / 2) >> lattice->bits;
}

/** Lattice coordinate of the centre of a voxel. */
static inline int64_t vxm_lattice_centre(const vxm_lattice *lattice, int64_t voxel) {
  return voxel * lattice->unit + lattice->unit / 2;
}

#endif
