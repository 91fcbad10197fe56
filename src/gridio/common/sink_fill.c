/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/sink_fill.h"
#include "base/bits.h"

#include <string.h>

static const int64_t *dims_of(const vxm_sink_filling *f) {
  return f->grid ? f->grid->space.dims : f->pieces ? f->pieces->space.dims : f->field->space.dims;
}

/** The part of a cube that the space has, counted from its first voxel; false if there is none. */
static bool clip(const vxm_sink_filling *f, const int64_t at[3], int64_t side, int64_t begin[3],
                 int64_t end[3]) {
  for (int a = 0; a < 3; a++) {
    begin[a] = vxm_max(at[a] - f->low[a], 0);
    end[a] = vxm_min(at[a] - f->low[a] + side, dims_of(f)[a]);
    if (begin[a] >= end[a])
      return false;
  }
  return true;
}

/* ---- Bits ---- */

/** Sets those of 8 voxels from x on that the grid has. */
static void or_byte(const vxm_sink_filling *f, int64_t x, int64_t y, int64_t z, uint64_t byte) {
  const int64_t *dims = f->grid->space.dims;
  if (byte == 0 || y < 0 || z < 0 || y >= dims[1] || z >= dims[2] || x <= -8 || x >= dims[0])
    return;
  if (x < 0) {
    byte >>= -x;
    x = 0;
  }
  if (dims[0] - x < 8)
    byte &= vxm_low_bits((unsigned)(dims[0] - x));
  uint64_t *row = vxm_grid_row(f->grid, y, z);
  unsigned shift = (unsigned)(x % 64);
  row[x / 64] |= byte << shift;
  if (shift > 56 && byte >> (64 - shift))
    row[x / 64 + 1] |= byte >> (64 - shift);
}

/** Bricks of a block, which need not begin where bricks do. */
static void add_bricks(const vxm_sink_filling *f, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]) {
  enum { ACROSS = 3 }; /* bricks that a block may meet */
  uint64_t bricks[ACROSS][ACROSS][ACROSS] = {{{0}}};
  int64_t first[3], off[3];
  for (int a = 0; a < 3; a++) {
    int64_t from = at[a] - f->low[a];
    off[a] = from & 3; /* of a negative one too */
    first[a] = from - off[a];
  }
  for (int x = 0; x < VXM_SINK_SIDE; x++)
    for (uint64_t left = bits[x]; left; left &= left - 1) {
      int bit = __builtin_ctzll(left);
      int64_t i = off[0] + x, j = off[1] + bit / 8, k = off[2] + bit % 8;
      bricks[i / 4][j / 4][k / 4] |= UINT64_C(1) << vxm_octree_bit(i, j, k);
    }
  for (int i = 0; i < ACROSS; i++)
    for (int j = 0; j < ACROSS; j++)
      for (int k = 0; k < ACROSS; k++)
        if (bricks[i][j][k])
          vxm_octree_pieces_brick(
              f->pieces, (int64_t[3]){first[0] + 4 * i, first[1] + 4 * j, first[2] + 4 * k}, bricks[i][j][k]);
}

void vxm_sink_fill_bits(vxm_sink_filling *f, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]) {
  if (f->pieces)
    add_bricks(f, at, bits);
  if (!f->grid)
    return;
  for (unsigned y = 0; y < 8; y++) {
    uint64_t plane = 0;
    for (unsigned x = 0; x < 8; x++)
      plane |= (bits[x] >> 8 * y & 0xff) << 8 * x;
    plane = vxm_transpose8(plane);
    for (unsigned z = 0; z < 8; z++)
      or_byte(f, at[0] - f->low[0], at[1] - f->low[1] + y, at[2] - f->low[2] + z, plane >> 8 * z & 0xff);
  }
}

/* ---- Numbers ---- */

static float *place_of(const vxm_sink_filling *f, int64_t x, int64_t y, int64_t z) {
  const int64_t *dims = f->field->space.dims;
  return (float *)(void *)f->field->values + (size_t)((x * dims[1] + y) * dims[2] + z);
}

void vxm_sink_fill_numbers(vxm_sink_filling *f, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]) {
  int64_t begin[3], end[3];
  if (!f->field || !clip(f, at, VXM_SINK_SIDE, begin, end))
    return;
  for (int64_t x = begin[0]; x < end[0]; x++)
    for (int64_t y = begin[1]; y < end[1]; y++) {
      int64_t dx = x + f->low[0] - at[0], dy = y + f->low[1] - at[1], dz = begin[2] + f->low[2] - at[2];
      memcpy(place_of(f, x, y, begin[2]), numbers + (dx * 8 + dy) * 8 + dz,
             (size_t)(end[2] - begin[2]) * sizeof *numbers);
    }
}

/* ---- Cubes ---- */

static void set_cube(const vxm_sink_filling *f, const int64_t begin[3], const int64_t end[3]) {
  for (int64_t z = begin[2]; z < end[2]; z++)
    for (int64_t y = begin[1]; y < end[1]; y++)
      vxm_row_set_span(vxm_grid_row(f->grid, y, z), begin[0], end[0]);
}

void vxm_sink_fill_cube(vxm_sink_filling *f, const int64_t at[3], int64_t side, float number) {
  int64_t begin[3], end[3];
  if (!clip(f, at, side, begin, end))
    return;
  if (f->grid) {
    set_cube(f, begin, end);
    return;
  }
  if (f->pieces) {
    vxm_octree_pieces_box(f->pieces, begin, end);
    return;
  }
  for (int64_t x = begin[0]; x < end[0]; x++)
    for (int64_t y = begin[1]; y < end[1]; y++) {
      float *row = place_of(f, x, y, begin[2]);
      for (int64_t z = begin[2]; z < end[2]; z++)
        *row++ = number;
    }
}
