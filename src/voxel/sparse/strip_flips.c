/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/sparse/strip_flips.h"
#include "base/bits.h"

size_t vxm_strip_flips_count(uint32_t *ends, const vxm_crossing_bin_piece *piece, int row_shift) {
  int shift = row_shift + 8;
  if (!piece->is_bitmap) {
    for (size_t i = 0; i < piece->count; i++)
      ends[piece->data[i] >> shift]++;
    return piece->count;
  }
  size_t total = 0;
  for (size_t i = 0; i < piece->count; i++) {
    size_t flips = (size_t)vxm_popcount(piece->data[i]);
    ends[64 * i >> shift] += (uint32_t)flips;
    total += flips;
  }
  return total;
}

void vxm_strip_flips_put(uint32_t *flips, uint32_t *parts, uint32_t *ends,
                         const vxm_crossing_bin_piece *piece, int row_shift, uint32_t part) {
  const uint64_t in_strip = vxm_low_bits((unsigned)row_shift + 8);
  for (size_t i = 0; i < piece->count; i++) {
    uint64_t left = piece->is_bitmap ? piece->data[i] : 1;
    for (; left; left &= left - 1) {
      uint64_t record = piece->is_bitmap ? 64 * i + (unsigned)__builtin_ctzll(left) : piece->data[i];
      uint32_t to = ends[record >> (row_shift + 8)]++;
      flips[to] = (uint32_t)(record & in_strip);
      parts[to] = part;
    }
  }
}
