/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/lattice.h"

#include <math.h>

enum {
  BITS_MIN = 8,
  BITS_MAX = 16,
  /* With differences up to 2^20 the products of three of them, summed, stay below 2^63. */
  COORDINATE_BITS = 20
};

vxm_lattice vxm_lattice_of(const vxm_space *space) {
  int64_t longest = space->dims[0];
  for (int a = 1; a < 3; a++)
    longest = space->dims[a] > longest ? space->dims[a] : longest;
  int bits = COORDINATE_BITS;
  while (bits > BITS_MIN && (longest << bits) > (INT64_C(1) << COORDINATE_BITS))
    bits--;
  if (bits > BITS_MAX)
    bits = BITS_MAX;
  return (vxm_lattice){bits, INT64_C(1) << bits, *space};
}

bool vxm_lattice_place(const vxm_lattice *lattice, const double position[3], vxm_point *point) {
  double steps[3];
  for (int a = 0; a < 3; a++) {
    double scale = (double)lattice->unit / lattice->space.voxel_size[a];
    steps[a] = (position[a] - lattice->space.origin[a]) * scale;
    if (!(fabs(steps[a]) < (double)VXM_LATTICE_MAX)) /* NaN too */
      return false;
  }
  for (int a = 0; a < 3; a++)
    point->at[a] = (int64_t)llrint(steps[a]);
  return true;
}
