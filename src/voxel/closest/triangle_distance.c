/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/closest/triangle_distance.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/** Makes a vector unit, unless it is 0, and returns the length that it had. */
static double normalize(double a[3]) {
  double length = sqrt(dot(a, a));
  double inverse = length > 0 ? 1 / length : 1;
  for (int i = 0; i < 3; i++)
    a[i] *= inverse;
  return length;
}

/** A unit vector at right angles to a unit vector. */
static void any_across(double out[3], const double a[3]) {
  int least = fabs(a[0]) < fabs(a[1]) ? 0 : 1;
  least = fabs(a[2]) < fabs(a[least]) ? 2 : least;
  double b[3] = {0, 0, 0};
  b[least] = 1;
  cross(out, a, b);
  normalize(out);
}

/** A unit vector in the plane, or (1, 0) in place of the zero vector, and the length. */
static double make_leg(double out[2], double along, double across) {
  double length = sqrt(along * along + across * across);
  out[0] = length > 0 ? along / length : 1;
  out[1] = length > 0 ? across / length : 0;
  return length;
}

/* The same operations in the same order as in triangle_frames.inc. */
void vxm_distance_triangle_make(vxm_distance_triangle *out, const double corner[3][3]) {
  double edge[3][3], length2[3];
  int longest = 0;
  for (int e = 0; e < 3; e++) {
    for (int a = 0; a < 3; a++)
      edge[e][a] = corner[(e + 1) % 3][a] - corner[e][a];
    length2[e] = dot(edge[e], edge[e]);
    longest = length2[e] > length2[longest] ? e : longest;
  }
  double *along = out->axis[0], *across = out->axis[1];
  memcpy(out->base, corner[longest], sizeof out->base);
  memcpy(along, edge[longest], sizeof edge[longest]);
  out->length = normalize(along);
  if (!(out->length > 0))
    along[0] = 1;
  out->apex[0] = 0;
  for (int a = 0; a < 3; a++)
    across[a] = -edge[(longest + 2) % 3][a];
  for (int twice = 0; twice < 2; twice++) { /* once leaves a sliver's axis askew */
    double part = dot(across, along);
    out->apex[0] += part;
    for (int a = 0; a < 3; a++)
      across[a] -= part * along[a];
  }
  out->apex[1] = normalize(across);
  if (!(out->apex[1] > VXM_DISTANCE_FLAT * out->length)) {
    out->apex[1] = 0;
    any_across(across, along);
  }
  cross(out->axis[2], along, across);
  out->leg_length[0] = make_leg(out->leg[0], out->apex[0] - out->length, out->apex[1]);
  out->leg_length[1] = make_leg(out->leg[1], out->apex[0], out->apex[1]);
}

static double clamp(double x, double most) {
  return x < 0 ? 0 : x > most ? most : x;
}

/* The same operations in the same order as in triangle_lanes.inc. */
double vxm_triangle_distance2(const vxm_distance_triangle *t, const double p[3]) {
  double at[3], off[3], least, square;
  for (int a = 0; a < 3; a++)
    off[a] = p[a] - t->base[a];
  for (int a = 0; a < 3; a++)
    at[a] = dot(off, t->axis[a]);
  double height2 = at[2] * at[2];
  bool is_inside = at[1] > 0;
  least = at[0] - clamp(at[0], t->length);
  least = least * least + at[1] * at[1];
  for (int i = 0; i < 2; i++) {
    double from = i == 0 ? at[0] - t->length : at[0];
    double along = from * t->leg[i][0] + at[1] * t->leg[i][1];
    double beside = at[1] * t->leg[i][0] - from * t->leg[i][1];
    is_inside = is_inside && (i == 0 ? beside > 0 : beside < 0);
    along -= clamp(along, t->leg_length[i]);
    square = along * along + beside * beside;
    least = square < least ? square : least;
  }
  return is_inside ? height2 : least + height2;
}
