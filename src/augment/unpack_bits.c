/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/unpack_bits.h"

#include <string.h>

size_t vxm_unpack_row_bytes(vxm_voxel_format voxels, int64_t dim) {
  size_t n = (size_t)dim;
  return voxels == VXM_VOXEL_FORMAT_PACKED  ? (n + 7) / 8
         : voxels == VXM_VOXEL_FORMAT_UINT8 ? n
                                            : n * sizeof(float);
}

/** Byte b of a row: its bits are voxels 8 b to 8 b + 7, on machines of either byte order. */
static inline unsigned byte_of(const uint64_t *row, size_t b) {
  return (unsigned)(row[b / 8] >> (8 * (b % 8))) & 255U;
}

static void spread_packed(unsigned char *out, const uint64_t *row, size_t dim) {
  for (size_t b = 0; b < (dim + 7) / 8; b++)
    out[b] = (unsigned char)byte_of(row, b);
}

static void spread_bytes(unsigned char *out, const uint64_t *row, size_t dim) {
  for (size_t i = 0; i < dim; i++)
    out[i] = (unsigned char)(row[i / 64] >> (i % 64) & 1);
}

static void spread_floats(float *out, const uint64_t *row, size_t dim) {
  for (size_t i = 0; i < dim; i++)
    out[i] = (float)(row[i / 64] >> (i % 64) & 1);
}

/** Eight bits at a time, from a table of what they become. */
static void spread_whole(unsigned char *out, const uint64_t *words, size_t bytes, const void *table,
                         size_t entry) {
  for (size_t b = 0; b < bytes; b++)
    memcpy(out + b * entry, (const unsigned char *)table + byte_of(words, b) * entry, entry);
}

static void spread_whole_bytes(unsigned char *out, const uint64_t *words, size_t bytes) {
  uint8_t table[256][8];
  for (int value = 0; value < 256; value++)
    for (int bit = 0; bit < 8; bit++)
      table[value][bit] = (uint8_t)(value >> bit & 1);
  spread_whole(out, words, bytes, table, sizeof table[0]);
}

static void spread_whole_floats(unsigned char *out, const uint64_t *words, size_t bytes) {
  float table[256][8];
  for (int value = 0; value < 256; value++)
    for (int bit = 0; bit < 8; bit++)
      table[value][bit] = (float)(value >> bit & 1);
  spread_whole(out, words, bytes, table, sizeof table[0]);
}

void vxm_unpack_row(void *out, vxm_voxel_format voxels, const uint64_t *words, size_t rows, int64_t dim) {
  size_t n = (size_t)dim, step = vxm_unpack_row_bytes(voxels, dim), row_words = (n + 63) / 64;
  unsigned char *to = out;
  /* Tables are worth it only for many voxels; rows without padding are one long row. */
  if (n % 64 == 0 && voxels != VXM_VOXEL_FORMAT_PACKED && rows * n >= 32768) {
    void (*const whole)(unsigned char *, const uint64_t *, size_t) =
        voxels == VXM_VOXEL_FORMAT_UINT8 ? spread_whole_bytes : spread_whole_floats;
    whole(to, words, rows * n / 8);
    return;
  }
  for (size_t r = 0; r < rows; r++, to += step, words += row_words)
    if (voxels == VXM_VOXEL_FORMAT_PACKED)
      spread_packed(to, words, n);
    else if (voxels == VXM_VOXEL_FORMAT_UINT8)
      spread_bytes(to, words, n);
    else
      spread_floats((float *)(void *)to, words, n);
}
