/* SPDX-License-Identifier: BSD-3-Clause */
/** Tiles of distances for any processor. */
#include "base/neon.h"
#include "voxel/closest/band_tile.h"

#include <math.h>
#include <string.h>

#define LANES 2
#define WIDTH 4
#define ACROSS 2
#define DOWN 2
#define DEEP 1
#define BUILD(name) name##_plain

typedef float wide __attribute__((vector_size(4 * WIDTH)));
typedef float narrow __attribute__((vector_size(4 * LANES)));
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lanes_int __attribute__((vector_size(8 * LANES)));
typedef double lanes_loaded __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef int32_t wide_mask __attribute__((vector_size(4 * WIDTH)));

#define INLINE static inline __attribute__((always_inline))

typedef float eight __attribute__((vector_size(32)));
typedef float eight_stored __attribute__((vector_size(32), aligned(4), may_alias));
typedef int32_t eight_int __attribute__((vector_size(32)));

INLINE eight eight_choose(eight_int mask, eight a, eight b) {
  return (eight)((mask & (eight_int)a) | (~mask & (eight_int)b));
}

INLINE eight eight_max(eight a, eight b) {
  return eight_choose(a > b, a, b);
}

INLINE eight eight_min(eight a, eight b) {
  return eight_choose(a < b, a, b);
}

INLINE eight eight_root(eight x) {
  for (int n = 0; n < 8; n++)
    x[n] = sqrtf(x[n]);
  return x;
}

INLINE unsigned eight_bits(eight_int mask) {
  unsigned bits = 0;
  for (unsigned n = 0; n < 8; n++)
    bits |= (unsigned)(mask[n] & 1) << n;
  return bits;
}

INLINE float eight_least(eight x) {
  float least = x[0];
  for (int n = 1; n < 8; n++)
    least = x[n] < least ? x[n] : least;
  return least;
}

INLINE float eight_sum(eight x) {
  float sum = 0;
  for (int n = 0; n < 8; n++)
    sum += x[n];
  return sum;
}

INLINE wide wide_max(wide a, wide b) {
  wide_mask is_a = a > b;
  return (wide)((is_a & (wide_mask)a) | (~is_a & (wide_mask)b));
}

INLINE wide wide_min(wide a, wide b) {
  wide_mask is_a = a < b;
  return (wide)((is_a & (wide_mask)a) | (~is_a & (wide_mask)b));
}

INLINE wide wide_size(wide x) {
  return (wide)((wide_mask)x & INT32_MAX);
}

INLINE wide wide_fma(wide a, wide b, wide c) {
  return a * b + c;
}

INLINE wide_mask wide_less(wide a, wide b) {
  return a < b;
}

INLINE wide_mask wide_not_above(wide a, wide b) {
  return ~(a > b);
}

INLINE wide_mask wide_both(wide_mask a, wide_mask b) {
  return a & b;
}

INLINE wide wide_unless(wide_mask mask, wide x) {
  return (wide)(~mask & (wide_mask)x);
}

INLINE unsigned wide_bits(wide_mask mask) {
#if defined(__SSE__) && defined(__GNUC__)
  return (unsigned)__builtin_ia32_movmskps((wide)mask);
#elif VXM_NEON
  return vxm_neon_signs4((int32x4_t)mask);
#else
  unsigned bits = 0;
  for (unsigned n = 0; n < WIDTH; n++)
    bits |= (unsigned)(mask[n] & 1) << n;
  return bits;
#endif
}

#include "voxel/closest/band_one_by_one.inc"

INLINE wide wide_gather(const float *from, const int32_t *place) {
  return (wide){from[place[0]], from[place[1]], from[place[2]], from[place[3]]};
}

INLINE unsigned lanes_bits(lanes_int mask) {
  return (unsigned)(mask[0] & 1) | (unsigned)(mask[1] & 2);
}

INLINE lanes lanes_choose(lanes_int mask, lanes a, lanes b) {
  return (lanes)((mask & (lanes_int)a) | (~mask & (lanes_int)b));
}

INLINE lanes lanes_max(lanes a, lanes b) {
  return lanes_choose(a > b, a, b);
}

INLINE lanes lanes_min(lanes a, lanes b) {
  return lanes_choose(a < b, a, b);
}

INLINE lanes lanes_root(lanes x) {
#if VXM_NEON
  return (lanes)vsqrtq_f64((float64x2_t)x);
#else
  return (lanes){sqrt(x[0]), sqrt(x[1])};
#endif
}

/** Not all processors can store past the cache. */
INLINE void store_past(float *to, narrow x) {
  memcpy(to, &x, sizeof x);
}

INLINE void end_past(void) {
}

#include "voxel/closest/band_tile_body.inc"
