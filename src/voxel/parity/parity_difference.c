/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/parity_difference.h"
#include "voxel/parity/edge_passages.h"

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
  vxm_edge_passages e;
  for (size_t f = begin; f < end; f++) {
    if (!vxm_edge_passages_of(&e, placed, triangles->corners[f], c->w, c->begin[c->w], c->end[c->w]))
      continue;
    vxm_edge_place u = vxm_edge_place_of(&placed->lattice, &e, c->u, c->w),
                   v = vxm_edge_place_of(&placed->lattice, &e, c->v, c->w);
    for (int64_t slice = e.first; slice < e.last; slice++, vxm_edge_place_step(&u), vxm_edge_place_step(&v)) {
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
