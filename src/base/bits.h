/* SPDX-License-Identifier: BSD-3-Clause */
/** Small arithmetic on 64-bit words and integers. */
#ifndef VXM_BASE_BITS_H
#define VXM_BASE_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

__extension__ typedef __int128 vxm_int128;
__extension__ typedef unsigned __int128 vxm_uint128;

/** Bit i of the result is the XOR of bits 0..i of `word`. */
static inline uint64_t vxm_prefix_xor(uint64_t word) {
  word ^= word << 1;
  word ^= word << 2;
  word ^= word << 4;
  word ^= word << 8;
  word ^= word << 16;
  word ^= word << 32;
  return word;
}

/** Bits 0..n-1 set, for 0 <= n <= 64. */
static inline uint64_t vxm_low_bits(unsigned n) {
  return n >= 64 ? ~UINT64_C(0) : (UINT64_C(1) << n) - 1;
}

/** In plain arithmetic: without a processor's own instruction the compiler's built-in is a call. */
static inline int vxm_popcount(uint64_t word) {
  word -= word >> 1 & UINT64_C(0x5555555555555555);
  word = (word & UINT64_C(0x3333333333333333)) + (word >> 2 & UINT64_C(0x3333333333333333));
  word = (word + (word >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
  return (int)(word * UINT64_C(0x0101010101010101) >> 56);
}

static inline int64_t vxm_min(int64_t a, int64_t b) {
  return a < b ? a : b;
}

static inline int64_t vxm_max(int64_t a, int64_t b) {
  return a > b ? a : b;
}

/** Bit c of word r goes to bit r of word c: blocks of 32, 16, ... 1 change places across the diagonal. */
static inline void vxm_transpose64(uint64_t block[64]) {
  uint64_t mask = UINT64_C(0x00000000ffffffff);
  for (unsigned size = 32; size > 0; size /= 2, mask ^= mask << size)
    for (unsigned base = 0; base < 64; base += 2 * size)
      for (unsigned r = base; r < base + size; r++) {
        uint64_t change = (block[r] >> size ^ block[r + size]) & mask;
        block[r] ^= change << size;
        block[r + size] ^= change;
      }
}

#endif
