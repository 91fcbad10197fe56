/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles of all kinds, for the tests of what measures distances to them. */
#ifndef VXM_TESTS_VOXEL_DISTANCE_TRIANGLES_H
#define VXM_TESTS_VOXEL_DISTANCE_TRIANGLES_H

#include "base/rng.h"

#include <stdbool.h>
#include <string.h>

typedef double triangle_corners[3][3];

/** Crowds of small ones, or few that are large; some far away; slivers, points, and the same ones again. */
static void fill_corners(triangle_corners *corners, size_t count, double extent, vxm_rng *rng, int kind) {
  for (size_t t = 0; t < count; t++) {
    double size = kind % 3 == 0 ? 0.3 : kind % 3 == 1 ? extent : extent / 8, from[3], along[3];
    bool is_far = kind % 5 == 4 && t % 7 == 0;
    for (int a = 0; a < 3; a++) {
      from[a] = extent * (1.4 * vxm_rng_unit(rng) - 0.2) + (is_far ? 1e5 * (vxm_rng_unit(rng) - 0.5) : 0);
      along[a] = size * (vxm_rng_unit(rng) - 0.5);
    }
    for (int c = 0; c < 3; c++) {
      double part = vxm_rng_unit(rng);
      for (int a = 0; a < 3; a++) {
        double off = size * (vxm_rng_unit(rng) - 0.5);
        off = t % 6 == 1 ? along[a] * part + 1e-7 * off : t % 6 == 2 ? along[a] * part : t % 6 == 3 ? 0 : off;
        corners[t][c][a] = from[a] + off;
      }
    }
    if (t > 0 && t % 11 == 0)
      memcpy(corners[t], corners[t - 1], sizeof *corners);
  }
}

#endif
