/* SPDX-License-Identifier: BSD-3-Clause */
/** Where an edge passes through slices of voxel centres: exactly, and told apart from the centres by the
 * perturbation of the lattice (voxel/lattice/lattice.h). */
#ifndef VXM_VOXEL_PARITY_EDGE_PASSAGES_H
#define VXM_VOXEL_PARITY_EDGE_PASSAGES_H

#include "base/bits.h"
#include "voxel/parity/snapped_points.h"

/** An edge, from its end that is lower along the axis across slices; it passes through the slices
 * first..last-1. */
typedef struct vxm_edge_passages {
  vxm_point from;
  int64_t along[3];
  int64_t first, last;
} vxm_edge_passages;

/** Where an edge lies along an axis in slice after slice: before the centre of `voxel`, the first of those it
 * is before; with the remainder of the division that told so. */
typedef struct vxm_edge_place {
  int64_t voxel, rest, voxel_step, rest_step, divisor;
} vxm_edge_place;

/** The slices across axis `w` of begin..end-1 that an edge passes through; false if there are none, as for
 * most edges of a fine mesh. */
static inline bool vxm_edge_passages_of(vxm_edge_passages *out, const vxm_snapped_points *placed,
                                        const uint32_t ends[2], int w, int64_t begin, int64_t end) {
  if (!placed->wide && ((placed->cells[ends[0]] ^ placed->cells[ends[1]]) & vxm_cell_mask(w)) == 0)
    return false;
  vxm_point from = vxm_snapped_points_at(placed, ends[0]), to = vxm_snapped_points_at(placed, ends[1]);
  bool is_up = from.at[w] <= to.at[w];
  out->from = is_up ? from : to;
  out->first = vxm_max(vxm_lattice_first(&placed->lattice, out->from.at[w]), begin);
  out->last = vxm_min(vxm_lattice_first(&placed->lattice, is_up ? to.at[w] : from.at[w]), end);
  for (int a = 0; a < 3; a++)
    out->along[a] = is_up ? to.at[a] - from.at[a] : from.at[a] - to.at[a];
  return out->first < out->last;
}

static inline int64_t vxm_floor_divide(int64_t number, int64_t divisor) {
  int64_t quotient = number / divisor;
  return quotient - (quotient * divisor > number);
}

/**
 * The place along `axis` in the first slice across axis `w`.
 *
 * Where an edge passes exactly at a centre, the centre is beyond it if its own perturbation along `axis` is
 * the larger one (it comes before w); else the edge, followed along w by the perturbation there, has moved
 * beyond the centre if it leads upward.
 */
static inline vxm_edge_place vxm_edge_place_of(const vxm_lattice *lattice, const vxm_edge_passages *e,
                                               int axis, int w) {
  int64_t up = e->along[w], side = e->along[axis];
  bool centre_is_beyond = axis < w || side <= 0;
  vxm_int128 number = (vxm_int128)(e->from.at[axis] - lattice->unit / 2) * up +
                      (vxm_int128)(vxm_lattice_centre(lattice, e->first) - e->from.at[w]) * side -
                      (centre_is_beyond ? 1 : 0);
  vxm_edge_place p = {.divisor = up * lattice->unit};
  vxm_int128 quotient;
  if (number == (int64_t)number) /* nearly always */
    quotient = vxm_floor_divide((int64_t)number, p.divisor);
  else {
    quotient = number / p.divisor;
    quotient -= quotient * p.divisor > number;
  }
  p.voxel = (int64_t)quotient + 1;
  p.rest = (int64_t)(number - quotient * p.divisor);
  p.voxel_step = vxm_floor_divide(side, up);
  p.rest_step = (side - p.voxel_step * up) * lattice->unit;
  return p;
}

/** In the next slice. */
static inline void vxm_edge_place_step(vxm_edge_place *p) {
  p->voxel += p->voxel_step;
  p->rest += p->rest_step;
  if (p->rest >= p->divisor) {
    p->rest -= p->divisor;
    p->voxel++;
  }
}

#endif
