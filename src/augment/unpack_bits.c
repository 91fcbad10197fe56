/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/unpack_bits.h"
#include "base/endian.h"

#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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

/** What eight bits become, for each byte. */
typedef float eight_floats[8];

static void make_table(eight_floats table[256]) {
  for (int value = 0; value < 256; value++)
    for (int bit = 0; bit < 8; bit++)
      table[value][bit] = (float)(value >> bit & 1);
}

#if defined(__SSE2__)
/** The whole words of a row, past the cache. @param out a multiple of 16 bytes */
static void stream_words(float *out, const uint64_t *row, size_t words, const eight_floats table[256]) {
  for (size_t w = 0; w < words; w++)
    for (size_t b = 0; b < 8; b++, out += 8) {
      const float *from = table[byte_of(row + w, b)];
      _mm_stream_ps(out, _mm_loadu_ps(from));
      _mm_stream_ps(out + 4, _mm_loadu_ps(from + 4));
    }
}
#endif

static void spread_floats(float *out, const uint64_t *row, size_t dim, const eight_floats table[256],
                          bool streaming) {
#if defined(__SSE2__)
  if (streaming && (uintptr_t)out % 16 == 0) {
    stream_words(out, row, dim / 64, table);
    out += dim / 64 * 64;
    row += dim / 64;
    dim %= 64;
  }
#else
  (void)streaming;
#endif
  for (; dim >= 64; dim -= 64, out += 64, row++)
    if (*row == 0) /* most are; compilers make a slow instruction of a memset of this length */
      for (size_t b = 0; b < 8; b++)
        memcpy(out + 8 * b, table[0], sizeof *table);
    else
      for (size_t b = 0; b < 8; b++)
        memcpy(out + 8 * b, table[byte_of(row, b)], sizeof *table);
  size_t b = 0;
  for (; b < dim / 8; b++)
    memcpy(out + 8 * b, table[byte_of(row, b)], sizeof *table);
  if (dim % 8)
    memcpy(out + 8 * b, table[byte_of(row, b)], dim % 8 * sizeof *out);
}

void vxm_unpack_row(void *out, vxm_voxel_format voxels, const uint64_t *words, size_t rows, int64_t dim,
                    bool streaming) {
  size_t n = (size_t)dim, step = vxm_unpack_row_bytes(voxels, dim), row_words = (n + 63) / 64;
  unsigned char *to = out;
  eight_floats table[256];
  if (voxels == VXM_VOXEL_FORMAT_FLOAT32)
    make_table(table);
  for (size_t r = 0; r < rows; r++, to += step, words += row_words)
    if (voxels == VXM_VOXEL_FORMAT_PACKED)
      spread_packed(to, words, n);
    else if (voxels == VXM_VOXEL_FORMAT_UINT8)
      vxm_unpack_words(to, words, n);
    else
      spread_floats((float *)(void *)to, words, n, (const eight_floats *)table, streaming);
#if defined(__SSE2__)
  _mm_sfence(); /* before another thread is told that they are there */
#endif
}
