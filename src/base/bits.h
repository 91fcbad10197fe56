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

static inline size_t vxm_min_size(size_t a, size_t b) {
  return a < b ? a : b;
}

static inline int64_t vxm_max(int64_t a, int64_t b) {
  return a > b ? a : b;
}

/* A line of the cache is compared as four vectors, which all processors have or take apart; gcc 12 makes a
 * loop over words of the plain form. */

/** Words of a line of the cache. */
enum { VXM_LINE_WORDS = 8 };

typedef uint64_t vxm_two_words __attribute__((vector_size(16), aligned(8), may_alias));

/** Whether all words of a line are `value`. */
static inline bool vxm_line_is(const uint64_t *line, uint64_t value) {
  const vxm_two_words *w = (const vxm_two_words *)(const void *)line, v = {value, value};
  vxm_two_words unlike = (w[0] ^ v) | (w[1] ^ v) | (w[2] ^ v) | (w[3] ^ v);
  return (unlike[0] | unlike[1]) == 0;
}

/** Whether all of some words are zero. */
static inline bool vxm_words_are_zero(const uint64_t *words, size_t count) {
  size_t w = 0;
  while (w + VXM_LINE_WORDS <= count && vxm_line_is(words + w, 0))
    w += VXM_LINE_WORDS;
  while (w < count && !words[w])
    w++;
  return w == count;
}

/** Whether two lines are the same. */
static inline bool vxm_lines_equal(const uint64_t *a, const uint64_t *b) {
  const vxm_two_words *v = (const vxm_two_words *)(const void *)a,
                      *w = (const vxm_two_words *)(const void *)b;
  vxm_two_words unlike = (v[0] ^ w[0]) | (v[1] ^ w[1]) | (v[2] ^ w[2]) | (v[3] ^ w[3]);
  return (unlike[0] | unlike[1]) == 0;
}

/** Bit c of byte r goes to bit r of byte c: blocks of 1, 2 and 4 bits change places across the diagonal. */
static inline uint64_t vxm_transpose8(uint64_t m) {
  uint64_t change = (m ^ m >> 7) & UINT64_C(0x00aa00aa00aa00aa);
  m ^= change ^ change << 7;
  change = (m ^ m >> 14) & UINT64_C(0x0000cccc0000cccc);
  m ^= change ^ change << 14;
  change = (m ^ m >> 28) & UINT64_C(0x00000000f0f0f0f0);
  return m ^ change ^ change << 28;
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
