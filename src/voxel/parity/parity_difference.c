/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/parity_difference.h"
#include "base/bits.h"

/** An edge, from its end that is lower along the axis across slices. */
typedef struct edge {
  vxm_point from;
  int64_t along[3];
} edge;

/** Where an edge lies along an axis in slice after slice: before the centre of `voxel`, the first of those it
 * is before; with the remainder of the division that told so. */
typedef struct place {
  int64_t voxel, rest, voxel_step, rest_step, divisor;
} place;

static int64_t floor_divide(int64_t number, int64_t divisor) {
  int64_t quotient = number / divisor;
  return quotient - (quotient * divisor > number);
}

/** floor (number / divisor), and the rest; most numbers fit 64 bits. */
static int64_t split(vxm_int128 number, int64_t divisor, int64_t *rest) {
  vxm_int128 quotient;
  if (number == (int64_t)number)
    quotient = floor_divide((int64_t)number, divisor);
  else {
    quotient = number / divisor;
    quotient -= quotient * divisor > number;
  }
  *rest = (int64_t)(number - quotient * divisor);
  return (int64_t)quotient;
}

/**
 * The place along `axis` in slice number `slice` across axis `w`.
 *
 * Where an edge passes exactly at a centre, the centre is beyond it if its own perturbation along `axis` is
 * the larger one (it comes before w); else the edge, followed along w by the perturbation there, has moved
 * beyond the centre if it leads upward.
 */
static place place_of(const vxm_lattice *lattice, const edge *e, int axis, int w, int64_t slice) {
  int64_t up = e->along[w], side = e->along[axis];
  bool centre_is_beyond = axis < w || side <= 0;
  vxm_int128 number = (vxm_int128)(e->from.at[axis] - lattice->unit / 2) * up +
                      (vxm_int128)(vxm_lattice_centre(lattice, slice) - e->from.at[w]) * side -
                      (centre_is_beyond ? 1 : 0);
  place p = {.divisor = up * lattice->unit};
  p.voxel = split(number, p.divisor, &p.rest) + 1;
  p.voxel_step = floor_divide(side, up);
  p.rest_step = (side - p.voxel_step * up) * lattice->unit;
  return p;
}

static void step(place *p) {
  p->voxel += p->voxel_step;
  p->rest += p->rest_step;
  if (p->rest >= p->divisor) {
    p->rest -= p->divisor;
    p->voxel++;
  }
}

/** Flips the voxel at (u, v) of a slice, numbers from the window on. */
static void put(const vxm_columns *c, uint64_t u, uint64_t v, uint64_t w, vxm_crossing_bins *bins,
                size_t worker, size_t voter, uint32_t part) {
  uint64_t mask = (UINT64_C(1) << c->slab_shift) - 1, slab;
  if (c->slab_axis == c->w) {
    slab = w >> c->slab_shift;
    w &= mask;
  } else {
    slab = v >> c->slab_shift;
    v &= mask;
  }
  vxm_crossing_bin *bin = vxm_crossing_bins_at(bins, worker, voter, slab);
  vxm_crossing_bin_begin(bins, worker, bin, part);
  vxm_crossing_bin_put(bins, worker, bin, u * c->step[c->u] + v * c->step[c->v] + w * c->step[c->w]);
}

void vxm_parity_difference_put(const vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                               size_t begin, size_t end, const vxm_columns *c, vxm_crossing_bins *bins,
                               size_t worker, size_t voter) {
  const vxm_lattice *lattice = &placed->lattice;
  uint64_t cell = vxm_cell_mask(c->w);
  for (size_t f = begin; f < end; f++) {
    const uint32_t *corner = triangles->corners[f];
    if (!placed->wide && ((placed->cells[corner[0]] ^ placed->cells[corner[1]]) & cell) == 0)
      continue; /* no slice lies between the ends: most edges of a fine mesh */
    edge e = {.from = vxm_snapped_points_at(placed, corner[0])};
    vxm_point to = vxm_snapped_points_at(placed, corner[1]);
    if (to.at[c->w] < e.from.at[c->w]) {
      vxm_point swap = to;
      to = e.from;
      e.from = swap;
    }
    int64_t slice = vxm_max(vxm_lattice_first(lattice, e.from.at[c->w]), c->begin[c->w]);
    int64_t last = vxm_min(vxm_lattice_first(lattice, to.at[c->w]), c->end[c->w]);
    if (slice >= last)
      continue;
    for (int a = 0; a < 3; a++)
      e.along[a] = to.at[a] - e.from.at[a];
    place u = place_of(lattice, &e, c->u, c->w, slice), v = place_of(lattice, &e, c->v, c->w, slice);
    for (; slice < last; slice++, step(&u), step(&v)) {
      if (u.voxel >= c->end[c->u] || v.voxel >= c->end[c->v])
        continue;
      if (v.voxel < c->begin[c->v] && !c->keep_before)
        continue;
      put(c, (uint64_t)(vxm_max(u.voxel, c->begin[c->u]) - c->begin[c->u]),
          (uint64_t)(vxm_max(v.voxel, c->begin[c->v]) - c->begin[c->v]), (uint64_t)(slice - c->begin[c->w]),
          bins, worker, voter, triangles->part[f]);
    }
  }
}
