/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/triangle.h"
#include "voxel/kernels_x86.h"

#include <math.h>
#include <string.h>

/** A triangle no higher than this, in voxels, is its edges: what lies inside is nearer to them than that. */
static const double height_min = 1e-6;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void scale(double a[3], double factor) {
  for (int i = 0; i < 3; i++)
    a[i] *= factor;
}

void vxm_triangle_make(vxm_triangle *out, const double corner[3][3]) {
  memcpy(out->corner, corner, sizeof out->corner);
  double length2[3];
  int longest = 0;
  for (int e = 0; e < 3; e++) {
    for (int a = 0; a < 3; a++)
      out->edge[e][a] = corner[(e + 1) % 3][a] - corner[e][a];
    length2[e] = dot(out->edge[e], out->edge[e]);
    out->inverse[e] = length2[e] > 0 ? 1 / length2[e] : 0;
    longest = length2[e] > length2[longest] ? e : longest;
  }
  /* The two shorter edges lose the fewest digits. */
  cross(out->normal, out->edge[(longest + 1) % 3], out->edge[(longest + 2) % 3]);
  double twice_area = sqrt(dot(out->normal, out->normal));
  out->has_inside = twice_area > height_min * sqrt(length2[longest]);
  if (!out->has_inside)
    return;
  scale(out->normal, 1 / twice_area);
  for (int e = 0; e < 3; e++) {
    cross(out->side[e], out->edge[e], out->normal);
    scale(out->side[e], sqrt(out->inverse[e]));
  }
}

double vxm_triangle_distance2(const vxm_triangle *triangle, const double p[3]) {
  double least = INFINITY, height = 0;
  bool is_inside = triangle->has_inside;
  for (int e = 0; e < 3 && is_inside; e++) {
    double beyond = 0;
    for (int a = 0; a < 3; a++)
      beyond += (p[a] - triangle->corner[e][a]) * triangle->side[e][a];
    is_inside = beyond <= 0;
  }
  if (is_inside) {
    for (int a = 0; a < 3; a++)
      height += (p[a] - triangle->corner[0][a]) * triangle->normal[a];
    return height * height;
  }
  for (int e = 0; e < 3; e++) {
    double from[3], square = 0;
    for (int a = 0; a < 3; a++)
      from[a] = p[a] - triangle->corner[e][a];
    double along = dot(from, triangle->edge[e]) * triangle->inverse[e];
    along = along < 0 ? 0 : along > 1 ? 1 : along;
    for (int a = 0; a < 3; a++) {
      double off = from[a] - along * triangle->edge[e][a];
      square += off * off;
    }
    least = square < least ? square : least;
  }
  return least;
}

extern vxm_triangle_row_fn vxm_triangle_lower_row_plain, vxm_triangle_lower_row_avx2;

vxm_triangle_row_fn *vxm_triangle_row_best(void) {
#if VXM_KERNELS_X86
  if (vxm_runs_avx2())
    return vxm_triangle_lower_row_avx2;
#endif
  return vxm_triangle_lower_row_plain;
}
