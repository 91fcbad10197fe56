/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/raycast.h"

#include <math.h>

typedef struct ray {
  double origin[3], direction[3];
  double inverse[3]; /**< 1 / direction; infinite along an axis the ray is square to */
  double step[3];    /**< its magnitude */
  int sign[3];       /**< of the direction: -1 or 1 */
} ray;

/** Cuts the ray to the box of the grid; gives where it enters and through which face. */
static bool enter_box(vxm_hit *hit, const ray *r, const int64_t dims[3]) {
  double leave = INFINITY;
  hit->t = 0;
  hit->axis = -1;
  for (int a = 0; a < 3; a++) {
    double far = (double)dims[a];
    if (r->direction[a] == 0) {
      if (r->origin[a] < 0 || r->origin[a] >= far)
        return false;
      continue;
    }
    bool up = r->direction[a] > 0;
    double in = ((up ? 0 : far) - r->origin[a]) * r->inverse[a];
    double out = ((up ? far : 0) - r->origin[a]) * r->inverse[a];
    if (in > hit->t) {
      hit->t = in;
      hit->axis = a;
      hit->positive = !up;
    }
    leave = out < leave ? out : leave;
  }
  return hit->t < leave;
}

/** The voxel index of a point along one axis, kept within low..high against rounding. */
static int64_t index_at(const ray *r, int axis, double t, int64_t low, int64_t high) {
  double at = r->origin[axis] + t * r->direction[axis];
  if (!(at > (double)low))
    return low;
  return at >= (double)high ? high : (int64_t)at;
}

/** Moves out of the empty block of 2^shift voxels that holds the voxel; the last blocks end where the grid
 * ends. */
static void leave_block(vxm_hit *hit, const ray *r, int shift, const int64_t dims[3]) {
  int64_t low[3], high[3];
  double nearest = INFINITY;
  int axis = 0;
  for (int a = 0; a < 3; a++) {
    low[a] = hit->voxel[a] >> shift << shift;
    high[a] = low[a] + (INT64_C(1) << shift);
    high[a] = high[a] < dims[a] ? high[a] : dims[a];
    if (r->direction[a] == 0)
      continue;
    double t = ((double)(r->direction[a] > 0 ? high[a] : low[a]) - r->origin[a]) * r->inverse[a];
    if (t < nearest) {
      nearest = t;
      axis = a;
    }
  }
  hit->t = nearest > hit->t ? nearest : hit->t;
  hit->axis = axis;
  hit->positive = r->direction[axis] < 0;
  for (int a = 0; a < 3; a++)
    if (a == axis)
      hit->voxel[a] = hit->positive ? low[a] - 1 : high[a];
    else
      hit->voxel[a] = index_at(r, a, hit->t, low[a], high[a] - 1);
}

/**
 * Goes voxel by voxel through a block of 4 x 4 x 4 (Amanatides & Woo 1987); true at a set one, false outside
 * the block. The few additions to `next` keep its rounding errors negligible.
 */
static bool search_block(vxm_hit *hit, const ray *r, uint64_t voxels) {
  double next[3], t = hit->t;
  int at[3], axis = -1;
  for (int a = 0; a < 3; a++) {
    at[a] = (int)(hit->voxel[a] & 3);
    next[a] = r->direction[a] == 0
                  ? INFINITY
                  : ((double)(hit->voxel[a] + (r->direction[a] > 0)) - r->origin[a]) * r->inverse[a];
  }
  int index = at[0] + 4 * at[1] + 16 * at[2];
  bool found;
  while (!(found = voxels >> index & 1)) {
    axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    t = next[axis] > t ? next[axis] : t;
    next[axis] += r->step[axis];
    at[axis] += r->sign[axis];
    index += r->sign[axis] * (1 << 2 * axis);
    if ((at[axis] & ~3) != 0)
      break;
  }
  if (axis >= 0) {
    hit->t = t;
    hit->axis = axis;
    hit->positive = r->direction[axis] < 0;
    for (int a = 0; a < 3; a++)
      hit->voxel[a] = (hit->voxel[a] & ~INT64_C(3)) + at[a];
  }
  return found;
}

bool vxm_raycast(vxm_hit *hit, const vxm_occupancy_mips *mips, const double origin[3],
                 const double direction[3]) {
  const int64_t *dims = mips->dims;
  ray r;
  for (int a = 0; a < 3; a++) {
    r.origin[a] = origin[a];
    r.direction[a] = direction[a];
    r.inverse[a] = 1 / direction[a];
    r.step[a] = fabs(r.inverse[a]);
    r.sign[a] = direction[a] < 0 ? -1 : 1;
  }
  if (!enter_box(hit, &r, dims))
    return false;
  for (int a = 0; a < 3; a++)
    hit->voxel[a] = index_at(&r, a, hit->t, 0, dims[a] - 1);
  /* The largest empty block around is left at once. */
  for (;;) {
    int64_t block = vxm_occupancy_mips_index(mips, hit->voxel);
    int gap = mips->gaps[block];
    if (gap > 0)
      leave_block(hit, &r, gap + 1, dims);
    else if (search_block(hit, &r, mips->blocks[block]))
      return true;
    int64_t at = hit->voxel[hit->axis];
    if (at < 0 || at >= dims[hit->axis])
      return false;
  }
}
