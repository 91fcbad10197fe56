/* SPDX-License-Identifier: BSD-3-Clause */
/** Nearest triangles for any processor. */
#include "base/neon.h"

#include <stdint.h>

#define LANES 2
#define WIDTH 4
#define BUILD(name) name##_plain

typedef float wide __attribute__((vector_size(4 * WIDTH)));
typedef int32_t wide_int __attribute__((vector_size(4 * WIDTH)));

static inline wide wide_choose(wide_int mask, wide a, wide b) {
  return (wide)((mask & (wide_int)a) | (~mask & (wide_int)b));
}

static inline wide wide_max(wide a, wide b) {
  return wide_choose(a > b, a, b);
}

static inline wide wide_min(wide a, wide b) {
  return wide_choose(a < b, a, b);
}

static inline unsigned wide_mask(wide_int mask) {
#if VXM_NEON
  return vxm_neon_signs4((int32x4_t)mask);
#else
  unsigned bits = 0;
  for (unsigned n = 0; n < WIDTH; n++)
    bits |= (unsigned)(mask[n] & 1) << n;
  return bits;
#endif
}

typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lanes_int __attribute__((vector_size(8 * LANES)));

static inline lanes lanes_choose(lanes_int mask, lanes a, lanes b) {
  return (lanes)((mask & (lanes_int)a) | (~mask & (lanes_int)b));
}

static inline lanes lanes_max(lanes a, lanes b) {
  return lanes_choose(a > b, a, b);
}

static inline lanes lanes_min(lanes a, lanes b) {
  return lanes_choose(a < b, a, b);
}

#include "voxel/closest/distance_bvh_body.inc"
