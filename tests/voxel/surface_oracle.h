/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Brute-force oracles for the surface: one voxel and one triangle, in 128-bit integers. A voxel is `unit`
 * lattice steps wide; voxel (i, j, k) reaches from (i, j, k) unit to (i + 1, j + 1, k + 1) unit. With
 * coordinates below 2^40 the largest numbers are below 2^125.
 */
#ifndef TEST_VOXEL_SURFACE_ORACLE_H
#define TEST_VOXEL_SURFACE_ORACLE_H

#include "base/bits.h"
#include "voxel/lattice/lattice.h"

typedef vxm_int128 oracle_wide;

static inline void oracle_cross(const oracle_wide a[3], const oracle_wide b[3], oracle_wide out[3]) {
  for (int c = 0; c < 3; c++)
    out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

/** Whether the projections of voxel and triangle onto an axis do not meet; both are closed. */
static inline bool oracle_apart(const oracle_wide axis[3], const vxm_point corner[3], const int64_t voxel[3],
                                int64_t unit) {
  oracle_wide low = 0, high = 0, box_low = 0, box_high = 0;
  for (int c = 0; c < 3; c++) {
    oracle_wide at = 0;
    for (int a = 0; a < 3; a++)
      at += axis[a] * (corner[c].at[a] - voxel[a] * unit);
    low = c == 0 || at < low ? at : low;
    high = c == 0 || at > high ? at : high;
  }
  for (int a = 0; a < 3; a++) {
    box_low += axis[a] < 0 ? axis[a] * unit : 0;
    box_high += axis[a] > 0 ? axis[a] * unit : 0;
  }
  return high < box_low || box_high < low;
}

/** The closed voxel meets the closed triangle: none of the 13 axes of the separating-axis theorem parts them.
 */
static inline bool oracle_touches(const vxm_point corner[3], const int64_t voxel[3], int64_t unit) {
  oracle_wide side[3][3], axis[3];
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      side[c][a] = corner[(c + 1) % 3].at[a] - corner[c].at[a];
  for (int k = 0; k < 3; k++) {
    oracle_wide straight[3] = {k == 0, k == 1, k == 2};
    if (oracle_apart(straight, corner, voxel, unit))
      return false;
    for (int c = 0; c < 3; c++) {
      oracle_cross(straight, side[c], axis);
      if (oracle_apart(axis, corner, voxel, unit))
        return false;
    }
  }
  oracle_cross(side[0], side[1], axis);
  return !oracle_apart(axis, corner, voxel, unit);
}

static inline oracle_wide oracle_size(oracle_wide a) {
  return a < 0 ? -a : a;
}

/**
 * Schwarz & Seidel 2010, section 3.4, with the voxel's centre c and everything doubled, so that it is whole:
 * the voxel meets the bounding box; |n . (c - v)| <= max |n_a| / 2 voxel; and in each projection, for each
 * edge, its inward normal m has m . (c - v) + max |m_a| / 2 voxel >= 0.
 */
static inline bool oracle_thin(const vxm_point corner[3], const int64_t voxel[3], int64_t unit) {
  oracle_wide side[3][3], normal[3], from[3][3]; /* from each corner to the centre, doubled */
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++) {
      side[c][a] = corner[(c + 1) % 3].at[a] - corner[c].at[a];
      from[c][a] = (2 * voxel[a] + 1) * unit - 2 * corner[c].at[a];
    }
  oracle_cross(side[0], side[1], normal);
  oracle_wide largest = 0, offset = 0;
  for (int a = 0; a < 3; a++) {
    if ((from[0][a] > unit && from[1][a] > unit && from[2][a] > unit) ||
        (from[0][a] < -unit && from[1][a] < -unit && from[2][a] < -unit))
      return false;
    largest = oracle_size(normal[a]) > largest ? oracle_size(normal[a]) : largest;
    offset += normal[a] * from[0][a];
  }
  if (oracle_size(offset) > largest * unit)
    return false;
  for (int w = 0; w < 3; w++)
    for (int c = 0; c < 3; c++) {
      int a = (w + 1) % 3, b = (w + 2) % 3, sign = normal[w] < 0 ? -1 : 1;
      oracle_wide at = (side[c][a] * from[c][b] - side[c][b] * from[c][a]) * sign;
      oracle_wide size_a = oracle_size(side[c][a]), size_b = oracle_size(side[c][b]);
      if (at + (size_a > size_b ? size_a : size_b) * unit < 0)
        return false;
    }
  return true;
}

#endif
