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

/** What eight bits become, of each byte. */
typedef struct spread_table {
  size_t entry; /**< bytes */
  union {
    uint8_t bytes[256][8];
    float floats[256][8];
  } of;
} spread_table;

static void make_table(spread_table *table, vxm_voxel_format voxels) {
  bool is_byte = voxels == VXM_VOXEL_FORMAT_UINT8;
  table->entry = is_byte ? sizeof table->of.bytes[0] : sizeof table->of.floats[0];
  for (int value = 0; value < 256; value++)
    for (int bit = 0; bit < 8; bit++)
      if (is_byte)
        table->of.bytes[value][bit] = (uint8_t)(value >> bit & 1);
      else
        table->of.floats[value][bit] = (float)(value >> bit & 1);
}

/** A row by a table with entries of so many bytes; most words of most rows are empty. */
static inline void spread_by_table(unsigned char *out, const uint64_t *row, size_t dim,
                                   const unsigned char *table, size_t entry) {
  for (; dim >= 64; dim -= 64, out += 8 * entry, row++)
    if (*row == 0) /* compilers make a slow instruction of a memset of this length */
      for (size_t b = 0; b < 8; b++)
        memcpy(out + b * entry, table, entry);
    else
      for (size_t b = 0; b < 8; b++)
        memcpy(out + b * entry, table + byte_of(row, b) * entry, entry);
  size_t b = 0;
  for (; b < dim / 8; b++)
    memcpy(out + b * entry, table + byte_of(row, b) * entry, entry);
  if (dim % 8)
    memcpy(out + b * entry, table + byte_of(row, b) * entry, dim % 8 * entry / 8);
}

static void spread_row(unsigned char *out, const uint64_t *row, size_t dim, const spread_table *table) {
  if (table->entry == sizeof table->of.bytes[0])
    spread_by_table(out, row, dim, table->of.bytes[0], sizeof table->of.bytes[0]);
  else
    spread_by_table(out, row, dim, (const unsigned char *)table->of.floats[0], sizeof table->of.floats[0]);
}

void vxm_unpack_row(void *out, vxm_voxel_format voxels, const uint64_t *words, size_t rows, int64_t dim) {
  const size_t many = 8192; /* voxels that are worth a table */
  size_t n = (size_t)dim, step = vxm_unpack_row_bytes(voxels, dim), row_words = (n + 63) / 64;
  unsigned char *to = out;
  spread_table table = {.entry = 0};
  if (voxels != VXM_VOXEL_FORMAT_PACKED && rows * n >= many)
    make_table(&table, voxels);
  for (size_t r = 0; r < rows; r++, to += step, words += row_words)
    if (voxels == VXM_VOXEL_FORMAT_PACKED)
      spread_packed(to, words, n);
    else if (table.entry > 0)
      spread_row(to, words, n, &table);
    else if (voxels == VXM_VOXEL_FORMAT_UINT8)
      spread_bytes(to, words, n);
    else
      spread_floats((float *)(void *)to, words, n);
}
