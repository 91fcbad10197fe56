/* SPDX-License-Identifier: BSD-3-Clause */
#include "experimental/touch.h"

static int64_t magnitude(int64_t value) {
  return value < 0 ? -value : value;
}

static void set_box(vxm_touch *out, const vxm_point p[3]) {
  for (int a = 0; a < 3; a++) {
    int64_t low = vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]);
    int64_t high = vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]);
    out->first[a] = vxm_first_touched_64(low, out->lattice->unit, out->lattice->bits);
    out->end[a] = vxm_end_touched_64(high, out->lattice->bits);
  }
}

void vxm_touch_make(vxm_touch *out, const vxm_lattice *lattice, const vxm_point corners[3], bool thin) {
  int64_t side[2][3];
  *out = (vxm_touch){.lattice = lattice};
  set_box(out, corners);
  for (int a = 0; a < 3; a++) {
    out->at[a] = corners[a];
    out->corner[a] = corners[0].at[a];
    side[0][a] = corners[1].at[a] - corners[0].at[a];
    side[1][a] = corners[2].at[a] - corners[0].at[a];
  }
  for (int axis = 0; axis < 3; axis++) {
    int p = (axis + 1) % 3, q = (axis + 2) % 3;
    out->normal[axis] = vxm_cross_64(side[0][p], side[0][q], side[1][p], side[1][q]);
    if (magnitude(out->normal[axis]) > magnitude(out->normal[out->dominant]))
      out->dominant = axis;
    for (int e = 0; e < 3; e++) {
      const int64_t *from = corners[e].at, *to = corners[(e + 1) % 3].at;
      out->edge[axis][e] =
          vxm_edge_of_64(to[p] - from[p], to[q] - from[q], lattice->unit / 2, out->normal[axis] >= 0, thin);
    }
  }
  out->reach = lattice->unit / 2 * vxm_plane_reach_64(out->normal[0], out->normal[1], out->normal[2], thin);
}

/** floor (t / d), d > 0. */
static int64_t round_down(int64_t t, int64_t d) {
  return t / d - (t % d < 0);
}

void vxm_touch_depths(const vxm_touch *touch, const int64_t voxel[3], int64_t *first, int64_t *last) {
  int w = touch->dominant, u = (w + 1) % 3, v = (w + 2) % 3;
  int64_t unit = touch->lattice->unit, step = magnitude(touch->normal[w]) * unit;
  if (step == 0) { /* no area: the plane is nowhere, and rules nothing out */
    *first = touch->first[w];
    *last = touch->end[w] - 1;
    return;
  }
  /* |across + k step| <= reach, with k counted from the first voxel of the box */
  int64_t across = touch->normal[u] * vxm_touch_from(touch, voxel[u], u, 0) +
                   touch->normal[v] * vxm_touch_from(touch, voxel[v], v, 0);
  across = touch->normal[w] < 0 ? -across : across;
  across += step / unit * vxm_touch_from(touch, touch->first[w], w, 0);
  *first = touch->first[w] - round_down(touch->reach + across, step);
  *last = touch->first[w] + round_down(touch->reach - across, step);
}
