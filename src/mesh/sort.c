/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/sort.h"

#include <string.h>

/** So few keys are sorted faster by insertion. */
enum { FEW = 24 };
enum { DIGIT_BITS = 12, DIGITS = 1 << DIGIT_BITS };

static void insertion_sort(uint64_t *keys, size_t count, unsigned shift) {
  for (size_t i = 1; i < count; i++) {
    uint64_t key = keys[i];
    size_t j = i;
    for (; j > 0 && keys[j - 1] >> shift > key >> shift; j--)
      keys[j] = keys[j - 1];
    keys[j] = key;
  }
}

/** Bits of a digit at most: fewer passes pay for longer digits from so many keys on. */
static unsigned longest_digit(size_t count) {
  return count < 2048 ? 8 : count < 16384 ? 11 : DIGIT_BITS;
}

/** Sorts by digits from bit `first` up, of those bits in which not all keys agree; digits are of about one
 * length. */
static void radix_sort(uint64_t *keys, uint64_t *scratch, size_t count, unsigned longest, unsigned first) {
  uint64_t varying = 0;
  for (size_t i = 1; i < count; i++)
    varying |= keys[i] ^ keys[0];
  const unsigned width = varying >> first ? 64 - (unsigned)__builtin_clzll(varying >> first) : 1,
                 passes = (width + longest - 1) / longest, bits = (width + passes - 1) / passes;
  const uint64_t mask = ((uint64_t)1 << bits) - 1;
  uint64_t *from = keys, *to = scratch;
  for (unsigned shift = first; shift < 64 && varying >> shift; shift += bits) {
    if ((varying >> shift & mask) == 0)
      continue;
    size_t place[DIGITS];
    memset(place, 0, sizeof *place << bits);
    for (size_t i = 0; i < count; i++)
      place[from[i] >> shift & mask]++;
    size_t total = 0;
    for (size_t d = 0; d <= mask; d++) {
      size_t n = place[d];
      place[d] = total;
      total += n;
    }
    for (size_t i = 0; i < count; i++)
      to[place[from[i] >> shift & mask]++] = from[i];
    uint64_t *swap = from;
    from = to;
    to = swap;
  }
  if (from != keys)
    memcpy(keys, from, count * sizeof *keys);
}

void vxm_sort_keys_above(uint64_t *keys, uint64_t *scratch, size_t count, unsigned shift) {
  if (count <= FEW)
    insertion_sort(keys, count, shift);
  else
    radix_sort(keys, scratch, count, longest_digit(count), shift);
}

void vxm_sort_keys(uint64_t *keys, uint64_t *scratch, size_t count) {
  vxm_sort_keys_above(keys, scratch, count, 0);
}
