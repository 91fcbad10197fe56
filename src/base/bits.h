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

static inline int vxm_popcount(uint64_t word) {
  return __builtin_popcountll(word);
}

/** Quotient rounded toward minus infinity; the divisor is positive. */
static inline int64_t vxm_floor_div(int64_t a, int64_t b) {
  int64_t q = a / b;
  return q - (a % b < 0);
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

/** a * b into *product; false if it overflows. */
static inline bool vxm_size_mul(size_t a, size_t b, size_t *product) {
  return !__builtin_mul_overflow(a, b, product);
}

#endif
