/* SPDX-License-Identifier: BSD-3-Clause */
/** Tiles of distances for any processor. */
#include "base/neon.h"

#include <math.h>
#include <stdint.h>
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

INLINE wide wide_max(wide a, wide b) {
  wide_mask is_a = a > b;
  return (wide)((is_a & (wide_mask)a) | (~is_a & (wide_mask)b));
}

INLINE wide wide_min(wide a, wide b) {
  wide_mask is_a = a < b;
  return (wide)((is_a & (wide_mask)a) | (~is_a & (wide_mask)b));
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

INLINE wide wide_root(wide x) {
#if VXM_NEON
  return (wide)vsqrtq_f32((float32x4_t)x);
#else
  return (wide){sqrtf(x[0]), sqrtf(x[1]), sqrtf(x[2]), sqrtf(x[3])};
#endif
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

INLINE lanes rows_load(const double *from) {
  return *(const lanes_loaded *)(const void *)from;
}

INLINE void rows_store(double *to, lanes x) {
  *(lanes_loaded *)(void *)to = x;
}

/** A number for each voxel of a row. */
INLINE lanes lanes_along(const double *from) {
  return *(const lanes_loaded *)(const void *)from;
}

/** A number for each row. */
INLINE lanes lanes_across(const double *from) {
  return from[0] - (lanes){0};
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
