/* SPDX-License-Identifier: BSD-3-Clause */
/** Numbers of either byte order at any address, and the words of little-endian files. */
#ifndef VXM_BASE_ENDIAN_H
#define VXM_BASE_ENDIAN_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/** Whether numbers of the given byte order must be turned round on this machine. */
static inline bool vxm_must_swap(bool big_endian) {
  return big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
}

static inline uint16_t vxm_load_u16(const void *at, bool swap) {
  uint16_t value;
  memcpy(&value, at, sizeof value);
  return swap ? __builtin_bswap16(value) : value;
}

static inline uint32_t vxm_load_u32(const void *at, bool swap) {
  uint32_t value;
  memcpy(&value, at, sizeof value);
  return swap ? __builtin_bswap32(value) : value;
}

static inline uint64_t vxm_load_u64(const void *at, bool swap) {
  uint64_t value;
  memcpy(&value, at, sizeof value);
  return swap ? __builtin_bswap64(value) : value;
}

static inline float vxm_load_f32(const void *at, bool swap) {
  uint32_t bits = vxm_load_u32(at, swap);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline double vxm_load_f64(const void *at, bool swap) {
  uint64_t bits = vxm_load_u64(at, swap);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline void vxm_store_u32(void *at, uint32_t value, bool swap) {
  if (swap)
    value = __builtin_bswap32(value);
  memcpy(at, &value, sizeof value);
}

static inline void vxm_store_f32(void *at, float value, bool swap) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  vxm_store_u32(at, bits, swap);
}

static inline void vxm_store_f64(void *at, double value, bool swap) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  if (swap)
    bits = __builtin_bswap64(bits);
  memcpy(at, &bits, sizeof bits);
}

/** Turns the bytes of each of `count` numbers of `size` bytes round. */
static inline void vxm_swap_each(unsigned char *bytes, size_t count, size_t size) {
  for (size_t n = 0; n < count; n++, bytes += size)
    for (size_t b = 0; b < size / 2; b++) {
      unsigned char kept = bytes[b];
      bytes[b] = bytes[size - 1 - b];
      bytes[size - 1 - b] = kept;
    }
}

/* ---- Little-endian files ---- */

static inline uint64_t vxm_le64(uint64_t word) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return __builtin_bswap64(word);
#else
  return word;
#endif
}

static inline uint32_t vxm_le32(uint32_t word) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  return __builtin_bswap32(word);
#else
  return word;
#endif
}

static inline unsigned vxm_load_le16(const unsigned char *bytes) {
  return bytes[0] | (unsigned)bytes[1] << 8;
}

static inline uint32_t vxm_load_le32(const unsigned char *bytes) {
  uint32_t word;
  memcpy(&word, bytes, sizeof word);
  return vxm_le32(word);
}

static inline uint64_t vxm_load_le64(const unsigned char *bytes) {
  uint64_t word;
  memcpy(&word, bytes, sizeof word);
  return vxm_le64(word);
}

/** The lowest 1 to 8 bytes of a word. */
static inline void vxm_store_le(unsigned char *bytes, uint64_t word, size_t count) {
  for (size_t b = 0; b < count; b++)
    bytes[b] = (unsigned char)(word >> 8 * b);
}

static inline void vxm_store_le32(unsigned char *bytes, uint32_t word) {
  vxm_store_le(bytes, word, 4);
}

static inline void vxm_store_le64(unsigned char *bytes, uint64_t word) {
  word = vxm_le64(word);
  memcpy(bytes, &word, sizeof word);
}

static inline double vxm_load_double(const unsigned char *bytes) {
  uint64_t word = vxm_load_le64(bytes);
  double value;
  memcpy(&value, &word, sizeof value);
  return value;
}

static inline void vxm_store_double(unsigned char *bytes, double value) {
  uint64_t word;
  memcpy(&word, &value, sizeof word);
  vxm_store_le64(bytes, word);
}

/** The IEEE number of 16 bits. */
static inline float vxm_half_value(unsigned bits) {
  int exponent = (int)(bits >> 10 & 31);
  float fraction = (float)(bits & 1023), value;
  if (exponent == 31)
    value = fraction > 0 ? NAN : INFINITY;
  else
    value = exponent == 0 ? ldexpf(fraction, -24) : ldexpf(fraction + 1024, exponent - 25);
  return bits >> 15 ? -value : value;
}

/**
 * 8 bytes (first byte lowest), each 0 or 1, to the 8 low bits. The product moves byte n to bit 56 + n; no two
 * of the moved bits meet.
 */
static inline uint64_t vxm_pack_bytes(uint64_t bytes) {
  return bytes * UINT64_C(0x0102040810204080) >> 56;
}

/** 1 for each byte that is not 0. Adding 0x7f to the low 7 bits carries into the top bit unless they are 0.
 */
static inline uint64_t vxm_nonzero_bytes(uint64_t bytes) {
  const uint64_t low = UINT64_C(0x7f7f7f7f7f7f7f7f);
  return (((bytes & low) + low) | bytes) >> 7 & UINT64_C(0x0101010101010101);
}

/** The inverse of vxm_pack_bytes: bit n of the low 8 to byte n. */
static inline uint64_t vxm_unpack_bits(uint64_t bits) {
  const uint64_t spread = UINT64_C(0x8040201008040201);
  return vxm_nonzero_bytes((bits & 0xff) * UINT64_C(0x0101010101010101) & spread);
}

/** The first `count` bits of words to a byte each. */
static inline void vxm_unpack_words(unsigned char *bytes, const uint64_t *words, size_t count) {
  size_t n = 0;
  for (; n + 8 <= count; n += 8)
    vxm_store_le64(bytes + n, vxm_unpack_bits(words[n / 64] >> (n % 64)));
  for (; n < count; n++)
    bytes[n] = (unsigned char)(words[n / 64] >> (n % 64) & 1);
}

#endif
