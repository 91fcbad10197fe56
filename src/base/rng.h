/* SPDX-License-Identifier: BSD-3-Clause */
/** A small seeded random sequence, the same on every machine. */
#ifndef VXM_BASE_RNG_H
#define VXM_BASE_RNG_H

#include "base/hash.h"

typedef struct vxm_rng {
  uint64_t state;
} vxm_rng;

/** splitmix64. */
static inline uint64_t vxm_rng_next(vxm_rng *rng) {
  rng->state += UINT64_C(0x9e3779b97f4a7c15);
  return vxm_mix(rng->state);
}

/** Uniform in [0, 1). */
static inline double vxm_rng_unit(vxm_rng *rng) {
  return (double)(vxm_rng_next(rng) >> 11) * 0x1p-53;
}

/** Uniform in 0..n-1; the bias of the plain product is below n / 2^64. */
static inline uint64_t vxm_rng_below(vxm_rng *rng, uint64_t n) {
  __extension__ typedef unsigned __int128 wide;
  return (uint64_t)(((wide)vxm_rng_next(rng) * n) >> 64);
}

#endif
