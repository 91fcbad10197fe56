/* SPDX-License-Identifier: BSD-3-Clause */
#include "tolerance.h"

#include "voxel/closest/triangle_distance.h"

double distance_of(const vxm_soup *soup, const vxm_space *space, const int64_t at[3]) {
  double p[3], least = INFINITY;
  for (int a = 0; a < 3; a++)
    p[a] = (double)at[a] + 0.5;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t i = 2; i < n; i++) {
      const uint32_t v[3] = {corner[0], corner[i - 1], corner[i]};
      double q[3][3];
      for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
          q[c][a] = (soup->positions[3 * (size_t)v[c] + (size_t)a] - space->origin[a]) / space->voxel_size[a];
      vxm_distance_triangle triangle;
      vxm_distance_triangle_make(&triangle, q);
      double d = vxm_triangle_distance2(&triangle, p);
      least = d < least ? d : least;
    }
  }
  return sqrt(least);
}
