/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/sparse/strip_flips.h"
#include "base/bits.h"

static void count_records(int shift, vxm_strip_ends *ends, const uint64_t *records, size_t count) {
  size_t share = count / VXM_STRIP_STREAMS;
  const uint64_t *a = records, *b = a + share, *c = b + share, *d = c + share;
  for (size_t i = 0; i < share; i++) {
    ends[a[i] >> shift][0]++;
    ends[b[i] >> shift][1]++;
    ends[c[i] >> shift][2]++;
    ends[d[i] >> shift][3]++;
  }
  for (size_t i = VXM_STRIP_STREAMS * share; i < count; i++)
    ends[records[i] >> shift][0]++;
}

size_t vxm_strip_flips_count(vxm_strip_ends *ends, const vxm_crossing_bin_piece *piece, int row_shift,
                             bool many) {
  int shift = row_shift + 8;
  if (!piece->is_bitmap) {
    for (size_t i = 0; i < piece->count && many; i++)
      ends[piece->data[i] >> shift][0]++;
    if (!many)
      count_records(shift, ends, piece->data, piece->count);
    return piece->count;
  }
  size_t total = 0;
  for (size_t i = 0; i < piece->count; i++) {
    size_t flips = (size_t)vxm_popcount(piece->data[i]);
    ends[64 * i >> shift][0] += (uint32_t)flips;
    total += flips;
  }
  return total;
}

/** How records of a slab become flips. */
typedef struct decoding {
  int row_shift;
  uint64_t in_row;
} decoding;

static inline vxm_strip_flip flip_of(decoding how, uint64_t record) {
  return (vxm_strip_flip)(record & how.in_row) << 8 | (vxm_strip_flip)(record >> how.row_shift & 255);
}

/** In all streams, as count_records has counted them. */
static void put_records(decoding how, vxm_strip_flip *flips, vxm_strip_ends *ends, const uint64_t *records,
                        size_t count) {
  int shift = how.row_shift + 8;
  size_t share = count / VXM_STRIP_STREAMS;
  const uint64_t *a = records, *b = a + share, *c = b + share, *d = c + share;
  for (size_t i = 0; i < share; i++) {
    flips[ends[a[i] >> shift][0]++] = flip_of(how, a[i]);
    flips[ends[b[i] >> shift][1]++] = flip_of(how, b[i]);
    flips[ends[c[i] >> shift][2]++] = flip_of(how, c[i]);
    flips[ends[d[i] >> shift][3]++] = flip_of(how, d[i]);
  }
  for (size_t i = VXM_STRIP_STREAMS * share; i < count; i++)
    flips[ends[records[i] >> shift][0]++] = flip_of(how, records[i]);
}

void vxm_strip_flips_put(vxm_strip_flip *flips, uint32_t *parts, vxm_strip_ends *ends,
                         const vxm_crossing_bin_piece *piece, int row_shift, uint32_t part) {
  decoding how = {row_shift, vxm_low_bits((unsigned)row_shift)};
  if (!parts && !piece->is_bitmap) {
    put_records(how, flips, ends, piece->data, piece->count);
    return;
  }
  for (size_t i = 0; i < piece->count; i++) {
    uint64_t left = piece->is_bitmap ? piece->data[i] : 1;
    for (; left; left &= left - 1) {
      uint64_t record = piece->is_bitmap ? 64 * i + (unsigned)__builtin_ctzll(left) : piece->data[i];
      uint32_t to = ends[record >> (row_shift + 8)][0]++;
      flips[to] = flip_of(how, record);
      if (parts)
        parts[to] = part;
    }
  }
}
