/* SPDX-License-Identifier: BSD-3-Clause */
/** Hashing of words, the same on every machine; not for adversaries. */
#ifndef VXM_BASE_HASH_H
#define VXM_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

/** Mixes a word so that every input bit reaches every output bit (the finalizer of splitmix64, Steele et al.
 * 2014). */
static inline uint64_t vxm_mix(uint64_t x) {
  x ^= x >> 30;
  x *= UINT64_C(0xbf58476d1ce4e5b9);
  x ^= x >> 27;
  x *= UINT64_C(0x94d049bb133111eb);
  x ^= x >> 31;
  return x;
}

/** Hash of a sequence, one word at a time: start with 0. */
static inline uint64_t vxm_hash_word(uint64_t hash, uint64_t word) {
  return vxm_mix(hash + UINT64_C(0x9e3779b97f4a7c15) + word);
}

/** Slots of a table for so many entries: a power of two, such that it is at most half full. */
static inline size_t vxm_hash_slots(size_t entries) {
  size_t slots = 16;
  while (slots < 2 * entries)
    slots *= 2;
  return slots;
}

#endif
