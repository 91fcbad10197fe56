/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", 2011): random words that are a
 * function of a counter and a key. Any of them can be had at any time, in any order and by any thread.
 */
#ifndef VXM_BASE_PHILOX_H
#define VXM_BASE_PHILOX_H

#include <stdint.h>

typedef struct vxm_philox_block {
  uint32_t word[4];
} vxm_philox_block;

enum { VXM_PHILOX_ROUNDS = 10 };

static inline vxm_philox_block vxm_philox_round(vxm_philox_block x, uint32_t key_0, uint32_t key_1) {
  uint64_t even = (uint64_t)UINT32_C(0xd2511f53) * x.word[0];
  uint64_t odd = (uint64_t)UINT32_C(0xcd9e8d57) * x.word[2];
  return (vxm_philox_block){{(uint32_t)(odd >> 32) ^ x.word[1] ^ key_0, (uint32_t)odd,
                             (uint32_t)(even >> 32) ^ x.word[3] ^ key_1, (uint32_t)even}};
}

/** The block of a counter; word 0 of the key is its low half. */
static inline vxm_philox_block vxm_philox(vxm_philox_block counter, uint64_t key) {
  uint32_t key_0 = (uint32_t)key, key_1 = (uint32_t)(key >> 32);
  for (int round = 0; round < VXM_PHILOX_ROUNDS; round++) {
    counter = vxm_philox_round(counter, key_0, key_1);
    key_0 += UINT32_C(0x9e3779b9);
    key_1 += UINT32_C(0xbb67ae85);
  }
  return counter;
}

#endif
