/* SPDX-License-Identifier: BSD-3-Clause */
/** Decimal numbers to doubles and back, correctly rounded and the same in every locale. */
#ifndef VXM_BASE_NUMBER_H
#define VXM_BASE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** Powers of ten that a double holds exactly. */
extern const double vxm_pow10[23];
/** Powers of ten below 2^64. */
extern const uint64_t vxm_pow10_u64[20];

/**
 * w * 10^e, rounded to nearest even. False if that takes more than 128-bit arithmetic (|e| > 27 and w not 0).
 */
bool vxm_decimal(uint64_t w, int e, double *value);

/**
 * Reads the number that text[0..length) consists of: sign, digits with an optional point, exponent by e, E, d
 * or D; nan, inf and infinity in any case. False if anything else is there.
 */
bool vxm_number_parse(const unsigned char *text, size_t length, double *value);

enum { VXM_NUMBER_ROOM = 40 };

/** Writes the shortest of 15 to 17 digits that read back bit for bit; returns the length. */
size_t vxm_number_write(char text[VXM_NUMBER_ROOM], double value);
/** As vxm_number_write, for a float (6 to 9 digits). */
size_t vxm_number_write_float(char text[VXM_NUMBER_ROOM], float value);
/** Decimal digits of an integer; returns the length (at most 20). */
size_t vxm_number_write_uint(char text[VXM_NUMBER_ROOM], uint64_t value);

/* ---- Eight digits at a time ---- */

/** Eight bytes as a word whose lowest byte is the first character. */
static inline uint64_t vxm_load8(const unsigned char *text) {
  uint64_t word;
  memcpy(&word, text, sizeof word);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  word = __builtin_bswap64(word);
#endif
  return word;
}

/** How many of the eight characters, from the first, are digits. */
static inline unsigned vxm_leading_digits(uint64_t word) {
  uint64_t x = word ^ UINT64_C(0x3030303030303030);
  /* 0..9 stay below 0x80 when 0x76 is added, 10..0x7f do not; bytes from 0x80 on have the bit already. */
  uint64_t other = (((x & UINT64_C(0x7f7f7f7f7f7f7f7f)) + UINT64_C(0x7676767676767676)) | x) &
                   UINT64_C(0x8080808080808080);
  return other ? (unsigned)__builtin_ctzll(other) / 8 : 8;
}

/** Value of the first n characters, all digits, 1 <= n <= 8. */
static inline uint64_t vxm_digits_value(uint64_t word, unsigned n) {
  uint64_t x = (word ^ UINT64_C(0x3030303030303030)) << (64 - 8 * n); /* zeros move in as leading digits */
  x = x * 10 + (x >> 8);                                              /* pairs, in every second byte */
  return (((x & UINT64_C(0x000000ff000000ff)) * UINT64_C(0x000f424000000064)) +
          (((x >> 16) & UINT64_C(0x000000ff000000ff)) * UINT64_C(0x0000271000000001))) >>
         32;
}

#endif
