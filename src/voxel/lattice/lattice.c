/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/lattice/lattice.h"

#include <inttypes.h>
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

vxm_status vxm_lattice_refuse(uint32_t vertex, const double p[3], vxm_error *error) {
  vxm_place place = {NULL, 0, -1, vertex};
  if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
    return vxm_fail_at(error, VXM_ERROR_RANGE, place,
                       "vertex %" PRIu32 " of the mesh is not finite; repair the mesh first", vertex);
  return vxm_fail_at(
      error, VXM_ERROR_RANGE, place,
      "vertex %" PRIu32
      " at (%g, %g, %g) lies too many voxels outside the grid; choose larger voxels or remove it",
      vertex, p[0], p[1], p[2]);
}
