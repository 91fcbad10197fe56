/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/closest_point.h"

#include <math.h>
#include <string.h>

/** Height of a triangle over its longest edge, below which that is too thin to tell where a foot inside lies.
 */
static const double thin = 1e-5;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void between(double out[3], const double a[3], const double b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = b[i] - a[i];
}

void vxm_closest_triangle_make(vxm_closest_triangle *out, const double at[3][3]) {
  double edge[3][3], longest2 = 0, area2 = 0;
  memcpy(out->at, at, sizeof out->at);
  for (int e = 0; e < 3; e++) {
    between(edge[e], at[e], at[(e + 1) % 3]);
    longest2 = fmax(longest2, dot(edge[e], edge[e]));
  }
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    double normal = edge[0][b] * edge[1][c] - edge[0][c] * edge[1][b];
    area2 += normal * normal;
  }
  out->is_thin = area2 <= thin * thin * longest2 * longest2;
}

/** Takes the foot on a segment if it is nearer than the one so far. */
static double lower_to_segment(const double p[3], const double a[3], const double b[3], double least,
                               double foot[3]) {
  double ab[3], ap[3], at[3], square = 0;
  between(ab, a, b);
  between(ap, a, p);
  double length2 = dot(ab, ab), along = length2 > 0 ? dot(ab, ap) / length2 : 0;
  along = along < 0 ? 0 : along > 1 ? 1 : along;
  for (int i = 0; i < 3; i++) {
    at[i] = a[i] + along * ab[i];
    square += (p[i] - at[i]) * (p[i] - at[i]);
  }
  if (square < least)
    memcpy(foot, at, sizeof at);
  return square < least ? square : least;
}

/** Ericson, Real-Time Collision Detection, section 5.1.5: the region of a corner, an edge or the inside. */
static void foot_by_region(const double at[3][3], const double p[3], double foot[3]) {
  const double *a = at[0], *b = at[1], *c = at[2];
  double ab[3], ac[3], ap[3], bp[3], cp[3], v = 0, w = 0;
  between(ab, a, b);
  between(ac, a, c);
  between(ap, a, p);
  between(bp, b, p);
  between(cp, c, p);
  double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
         d6 = dot(ac, cp);
  double at_a = d3 * d6 - d5 * d4, at_b = d5 * d2 - d1 * d6, at_c = d1 * d4 - d3 * d2;
  if (d1 <= 0 && d2 <= 0) {
    /* a */
  } else if (d3 >= 0 && d4 <= d3)
    v = 1;
  else if (d6 >= 0 && d5 <= d6)
    w = 1;
  else if (at_c <= 0 && d1 >= 0 && d3 <= 0)
    v = d1 / (d1 - d3);
  else if (at_b <= 0 && d2 >= 0 && d6 <= 0)
    w = d2 / (d2 - d6);
  else if (at_a <= 0 && d4 >= d3 && d5 >= d6) {
    w = (d4 - d3) / (d4 - d3 + (d5 - d6));
    v = 1 - w;
  } else {
    v = at_b / (at_a + at_b + at_c);
    w = at_c / (at_a + at_b + at_c);
  }
  for (int i = 0; i < 3; i++)
    foot[i] = a[i] + v * ab[i] + w * ac[i];
}

double vxm_closest_point(const vxm_closest_triangle *corners, const double p[3], double foot[3]) {
  const double(*at)[3] = (const double(*)[3])corners->at;
  if (corners->is_thin) {
    double least = lower_to_segment(p, at[0], at[1], INFINITY, foot);
    least = lower_to_segment(p, at[1], at[2], least, foot);
    return lower_to_segment(p, at[2], at[0], least, foot);
  }
  double off[3];
  foot_by_region(at, p, foot);
  between(off, foot, p);
  return dot(off, off);
}
