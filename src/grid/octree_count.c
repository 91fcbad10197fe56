/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_count.h"

static uint64_t *count_at(const vxm_octree_counts *box, int64_t x, int64_t y, int64_t z) {
  int64_t rows = box->end[1] - box->begin[1], length = box->end[2] - box->begin[2];
  return &box->counts[((x - box->begin[0]) * rows + (y - box->begin[1])) * length + (z - box->begin[2])];
}

/** Voxels of cube c along an axis that lie from `at` to `end`. */
static uint64_t overlap(int64_t c, int64_t side, int64_t at, int64_t end) {
  return (uint64_t)(vxm_min((c + 1) * side, end) - vxm_max(c * side, at));
}

void vxm_octree_count_some(const vxm_octree_counts *box, const int64_t at[3], uint64_t voxels) {
  int64_t c[3];
  for (int a = 0; a < 3; a++) {
    c[a] = at[a] / box->side;
    if (c[a] < box->begin[a] || c[a] >= box->end[a])
      return;
  }
  *count_at(box, c[0], c[1], c[2]) += voxels;
}

void vxm_octree_count_cube(const vxm_octree_counts *box, const int64_t at[3], int64_t side) {
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = vxm_max(at[a] / box->side, box->begin[a]);
    high[a] = vxm_min((at[a] + side - 1) / box->side + 1, box->end[a]);
  }
  for (int64_t x = low[0]; x < high[0]; x++)
    for (int64_t y = low[1]; y < high[1]; y++) {
      uint64_t area = overlap(x, box->side, at[0], at[0] + side) * overlap(y, box->side, at[1], at[1] + side);
      for (int64_t z = low[2]; z < high[2]; z++)
        *count_at(box, x, y, z) += area * overlap(z, box->side, at[2], at[2] + side);
    }
}

/** Cubes of one or two voxels: a brick has several. */
static void count_brick(const vxm_octree_counts *box, const int64_t at[3], uint64_t bits) {
  int64_t side = box->side;
  uint64_t cube = side == 1 ? 1 : UINT64_C(0x330033);
  for (int64_t z = 0; z < 4; z += side)
    for (int64_t y = 0; y < 4; y += side)
      for (int64_t x = 0; x < 4; x += side) {
        uint64_t some = bits >> vxm_octree_bit(x, y, z) & cube;
        if (some)
          vxm_octree_count_some(box, (int64_t[3]){at[0] + x, at[1] + y, at[2] + z},
                                (uint64_t)vxm_popcount(some));
      }
}

static void count_piece(const vxm_sparse_piece *piece, void *payload) {
  const vxm_octree_counts *box = payload;
  if (piece->bits == ~UINT64_C(0))
    vxm_octree_count_cube(box, piece->position, piece->side);
  else if (box->side >= 4)
    vxm_octree_count_some(box, piece->position, (uint64_t)vxm_popcount(piece->bits));
  else
    count_brick(box, piece->position, piece->bits);
}

void vxm_octree_count(const vxm_octree_counts *box, const vxm_sparse *sparse) {
  vxm_octree_counts counted = *box;
  int64_t begin[3], end[3];
  for (int a = 0; a < 3; a++) {
    begin[a] = box->begin[a] * box->side;
    end[a] = box->end[a] * box->side;
  }
  vxm_octree_walk(sparse, begin, end, count_piece, &counted);
}
