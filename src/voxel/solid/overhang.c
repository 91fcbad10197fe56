/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/overhang.h"
#include "voxel/lattice/lattice.h"

#include <math.h>
#include <string.h>

/** A triangle cut by six planes has nine corners at most. */
enum { CORNERS_MAX = 9 };

typedef struct polygon {
  double at[CORNERS_MAX][3];
  int count;
} polygon;

typedef struct grid_box {
  double low[3], high[3];
  double least[3], most[3]; /**< what still counts as within: a little more */
  const double *transform;  /**< of what is looked at; NULL = none */
} grid_box;

static grid_box box_of(const vxm_space *space, const double transform[12]) {
  const double slack = 1.0 / 64; /* of a voxel: positions are rounded to less than that */
  grid_box box = {.transform = transform};
  for (int a = 0; a < 3; a++) {
    double size = space->voxel_size[a];
    box.low[a] = space->origin[a];
    box.high[a] = space->origin[a] + (double)space->dims[a] * size;
    box.least[a] = box.low[a] - slack * size;
    box.most[a] = box.high[a] + slack * size;
  }
  return box;
}

static void place(double out[3], const grid_box *box, const double p[3]) {
  if (box->transform)
    vxm_transform_position(box->transform, p, out);
  else
    memcpy(out, p, 3 * sizeof *p);
}

/** Whether all points lie in the grid, as the corners of their box do. */
static bool is_within(const grid_box *box, const vxm_triangle_set *triangles) {
  for (int corner = 0; corner < 8; corner++) {
    double at[3], p[3];
    for (int a = 0; a < 3; a++)
      at[a] = corner >> a & 1 ? triangles->high[a] : triangles->low[a];
    place(p, box, at);
    for (int a = 0; a < 3; a++)
      if (p[a] < box->least[a] || p[a] > box->most[a])
        return false;
  }
  return true;
}

static double area_of(const polygon *p) {
  double sum[3] = {0, 0, 0};
  for (int k = 1; k + 1 < p->count; k++)
    for (int a = 0; a < 3; a++) {
      int b = (a + 1) % 3, c = (a + 2) % 3;
      sum[a] += (p->at[k][b] - p->at[0][b]) * (p->at[k + 1][c] - p->at[0][c]) -
                (p->at[k][c] - p->at[0][c]) * (p->at[k + 1][b] - p->at[0][b]);
    }
  return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 2;
}

/** Cuts off what lies beyond a plane across an axis (Sutherland and Hodgman 1974). */
static void cut(polygon *p, int axis, double plane, double sign) {
  polygon kept = {.count = 0};
  for (int k = 0; k < p->count; k++) {
    const double *from = p->at[k], *to = p->at[(k + 1) % p->count];
    double before = sign * (from[axis] - plane), after = sign * (to[axis] - plane);
    if (before <= 0 && kept.count < CORNERS_MAX)
      memcpy(kept.at[kept.count++], from, sizeof kept.at[0]);
    if ((before > 0) == (after > 0) || kept.count == CORNERS_MAX)
      continue;
    double share = before / (before - after);
    for (int a = 0; a < 3; a++)
      kept.at[kept.count][a] = from[a] + share * (to[a] - from[a]);
    kept.count++;
  }
  *p = kept;
}

/** Adds a triangle's area to `all`, and to `outside` what lies there. */
static void add(vxm_overhang *out, double *all, double *outside, const grid_box *box, polygon *triangle) {
  double area = area_of(triangle);
  bool is_cut = false;
  *all += area;
  for (int a = 0; a < 3; a++) { /* each side of its own: what one cuts off may lie beyond another */
    double low = fmin(fmin(triangle->at[0][a], triangle->at[1][a]), triangle->at[2][a]);
    double high = fmax(fmax(triangle->at[0][a], triangle->at[1][a]), triangle->at[2][a]);
    out->below[a] |= low < box->least[a];
    out->above[a] |= high > box->most[a];
    is_cut |= low < box->least[a] || high > box->most[a];
  }
  for (int a = 0; a < 3 && is_cut; a++) {
    cut(triangle, a, box->high[a], 1);
    cut(triangle, a, box->low[a], -1);
  }
  if (is_cut)
    *outside += fmax(area - area_of(triangle), 0);
}

vxm_overhang vxm_overhang_of(const vxm_triangle_set *triangles, const vxm_space *space,
                             const double transform[12]) {
  grid_box box = box_of(space, transform);
  vxm_overhang out = {.share = 0};
  double all = 0, outside = 0;
  if (is_within(&box, triangles))
    return out;
  for (size_t t = 0; t < triangles->triangle_count; t++) {
    polygon triangle = {.count = 3};
    if (vxm_role_of(triangles, t) != VXM_ROLE_FACE)
      continue;
    for (int k = 0; k < 3; k++)
      place(triangle.at[k], &box, triangles->positions[triangles->corners[t][k]]);
    add(&out, &all, &outside, &box, &triangle);
  }
  out.share = all > 0 ? fmin(outside / all, 1) : 0;
  return out;
}
