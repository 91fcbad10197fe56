/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/triangle.h"

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

/* Points are taken four at a time; compilers make two vectors of two of them where there are none of four. */

typedef double four __attribute__((vector_size(32)));
typedef int64_t four_masks __attribute__((vector_size(32)));
typedef float four_floats __attribute__((vector_size(16)));

#define INLINE static inline __attribute__((always_inline))

INLINE void choose(four *out, const four_masks *mask, const four *a, const four *b) {
  *out = (four)((*mask & (four_masks)*a) | (~*mask & (four_masks)*b));
}

/** a = the lesser of a and b. */
INLINE void lower(four *a, const four *b) {
  four_masks is_less = *b < *a;
  choose(a, &is_less, b, a);
}

INLINE bool is_any(const four_masks *mask) {
  return ((*mask)[0] | (*mask)[1] | (*mask)[2] | (*mask)[3]) != 0;
}

/** Squared distances to the edges. */
INLINE void to_edges(four *out, const vxm_triangle *t, const four p[3]) {
  const four zero = {0, 0, 0, 0}, one = zero + 1;
  *out = zero + (double)INFINITY;
  for (int e = 0; e < 3; e++) {
    four from[3], along = zero, square = zero;
    for (int a = 0; a < 3; a++) {
      from[a] = p[a] - t->corner[e][a];
      along += from[a] * t->edge[e][a];
    }
    along *= t->inverse[e];
    four_masks is_before = along<zero, is_behind = along> one;
    choose(&along, &is_before, &zero, &along);
    choose(&along, &is_behind, &one, &along);
    for (int a = 0; a < 3; a++) {
      four off = from[a] - along * t->edge[e][a];
      square += off * off;
    }
    lower(out, &square);
  }
}

/** Squared distances to the plane, and whether the foot lies in the triangle. */
INLINE void to_plane(four *out, four_masks *is_inside, const vxm_triangle *t, const four p[3]) {
  const four zero = {0, 0, 0, 0};
  four height = zero;
  for (int a = 0; a < 3; a++)
    height += (p[a] - t->corner[0][a]) * t->normal[a];
  *out = height * height;
  *is_inside = zero == zero;
  for (int e = 0; e < 3; e++) {
    four beyond = zero;
    for (int a = 0; a < 3; a++)
      beyond += (p[a] - t->corner[e][a]) * t->side[e][a];
    *is_inside &= beyond <= zero;
  }
}

INLINE void distances2(four *out, const vxm_triangle *t, const four p[3]) {
  if (!t->has_inside) {
    to_edges(out, t, p);
    return;
  }
  four plane;
  four_masks is_inside, is_outside;
  to_plane(&plane, &is_inside, t, p);
  is_outside = ~is_inside;
  *out = plane;
  if (!is_any(&is_outside))
    return;
  four edges;
  to_edges(&edges, t, p);
  choose(out, &is_inside, &plane, &edges);
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

void vxm_triangle_lower_row(const vxm_triangle *triangle, const double first[3], double step, float *row,
                            int64_t count) {
  const four zero = {0, 0, 0, 0}, ahead = {0, 1, 2, 3};
  four p[3] = {zero, zero + first[1], zero + first[2]};
  for (int64_t i = 0; i < count; i += 4) {
    p[0] = first[0] + ((double)i + ahead) * step;
    four wide;
    distances2(&wide, triangle, p);
    four_floats made = __builtin_convertvector(wide, four_floats), had;
    size_t some = (size_t)(count - i < 4 ? count - i : 4) * sizeof *row;
    if (some == sizeof had) {
      memcpy(&had, row + i, sizeof had);
      typedef int32_t masks __attribute__((vector_size(16)));
      masks is_less = made < had;
      masks least = (is_less & (masks)made) | (~is_less & (masks)had);
      memcpy(row + i, &least, sizeof least);
      continue;
    }
    for (int64_t n = i; n < count; n++)
      row[n] = made[n - i] < row[n] ? made[n - i] : row[n];
  }
}
