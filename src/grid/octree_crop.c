/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/octree_crop.h"
#include "grid/crop.h"

typedef struct crop {
  const int64_t *begin, *end;
  vxm_grid *grid;
} crop;

/** Sets the voxels of a cube that the box has. */
static void put_cube(const crop *c, const int64_t at[3], int64_t side) {
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = vxm_max(at[a], c->begin[a]) - c->begin[a];
    high[a] = vxm_min(at[a] + side, c->end[a]) - c->begin[a];
  }
  for (int64_t k = low[2]; k < high[2]; k++)
    for (int64_t j = low[1]; j < high[1]; j++)
      vxm_row_set_span(vxm_grid_row(c->grid, j, k), low[0], high[0]);
}

/** Sets those of 4 voxels from x on that the row has; x counts from the box. */
static void put_four(uint64_t *row, int64_t x, int64_t length, uint64_t bits) {
  if (x < 0)
    bits >>= -x;
  x = vxm_max(x, 0);
  if (length - x < 4)
    bits &= vxm_low_bits((unsigned)(length - x));
  unsigned shift = (unsigned)(x % 64);
  row[x / 64] |= bits << shift;
  if (shift > 60 && bits >> (64 - shift))
    row[x / 64 + 1] |= bits >> (64 - shift);
}

static void put_brick(const crop *c, const int64_t at[3], uint64_t bits) {
  for (int64_t k = vxm_max(at[2], c->begin[2]); k < vxm_min(at[2] + 4, c->end[2]); k++)
    for (int64_t j = vxm_max(at[1], c->begin[1]); j < vxm_min(at[1] + 4, c->end[1]); j++) {
      uint64_t four = bits >> (16 * (k - at[2]) + 4 * (j - at[1])) & 15;
      if (four)
        put_four(vxm_grid_row(c->grid, j - c->begin[1], k - c->begin[2]), at[0] - c->begin[0],
                 c->end[0] - c->begin[0], four);
    }
}

static void put_piece(const vxm_sparse_piece *piece, void *payload) {
  const crop *c = payload;
  if (piece->bits == ~UINT64_C(0))
    put_cube(c, piece->position, piece->side);
  else
    put_brick(c, piece->position, piece->bits);
}

vxm_status vxm_octree_crop(vxm_grid **out, const vxm_sparse *sparse, const int64_t begin[3],
                           const int64_t end[3], vxm_error *error) {
  vxm_space space = vxm_space_of_box(&sparse->space, begin, end);
  vxm_status status = vxm_grid_create(out, sparse->context, &space, error);
  if (status != VXM_OK)
    return status;
  crop c = {begin, end, *out};
  vxm_octree_walk(sparse, begin, end, put_piece, &c);
  return VXM_OK;
}
