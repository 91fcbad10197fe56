/* SPDX-License-Identifier: BSD-3-Clause */
/** Tiles of distances for x86 processors with AVX-512. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include <immintrin.h>
#include <stdint.h>
#if defined(__clang__)
#pragma clang attribute push(                                                                 \
    __attribute__((target("avx512f,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt"))), \
    apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt")
#endif

#define LANES 8
#define WIDTH 16
#define ACROSS 4
#define DOWN 2
#define DEEP 2
#define BUILD(name) name##_avx512

typedef float wide __attribute__((vector_size(4 * WIDTH)));
typedef float narrow __attribute__((vector_size(4 * LANES)));
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lanes_int __attribute__((vector_size(8 * LANES)));
typedef double lanes_loaded __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef __mmask16 wide_mask;

#define INLINE static inline __attribute__((always_inline))

INLINE wide wide_max(wide a, wide b) {
  return (wide)_mm512_max_ps((__m512)a, (__m512)b);
}

INLINE wide wide_min(wide a, wide b) {
  return (wide)_mm512_min_ps((__m512)a, (__m512)b);
}

INLINE wide wide_fma(wide a, wide b, wide c) {
  return (wide)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}

INLINE wide_mask wide_less(wide a, wide b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}

INLINE wide_mask wide_not_above(wide a, wide b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_NGT_UQ);
}

INLINE wide_mask wide_both(wide_mask a, wide_mask b) {
  return a & b;
}

INLINE wide wide_unless(wide_mask mask, wide x) {
  return (wide)_mm512_maskz_mov_ps((__mmask16)~mask, (__m512)x);
}

INLINE wide wide_root(wide x) {
  return (wide)_mm512_sqrt_ps((__m512)x);
}

INLINE unsigned wide_bits(wide_mask mask) {
  return mask;
}

/* Two rows of four. */

enum { NEXT_ROW = 40 };

INLINE lanes rows_load(const double *from) {
  return (lanes)_mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(from)),
                                   _mm256_loadu_pd(from + NEXT_ROW), 1);
}

INLINE void rows_store(double *to, lanes x) {
  _mm256_storeu_pd(to, _mm512_castpd512_pd256((__m512d)x));
  _mm256_storeu_pd(to + NEXT_ROW, _mm512_extractf64x4_pd((__m512d)x, 1));
}

/** A number for each voxel of a row. */
INLINE lanes lanes_along(const double *from) {
  return (lanes)_mm512_broadcast_f64x4(_mm256_loadu_pd(from));
}

/** A number for each row. */
INLINE lanes lanes_across(const double *from) {
  return (lanes)_mm512_insertf64x4(_mm512_set1_pd(from[0]), _mm256_set1_pd(from[1]), 1);
}

INLINE lanes lanes_max(lanes a, lanes b) {
  return (lanes)_mm512_max_pd((__m512d)a, (__m512d)b);
}

INLINE lanes lanes_min(lanes a, lanes b) {
  return (lanes)_mm512_min_pd((__m512d)a, (__m512d)b);
}

INLINE unsigned lanes_bits(lanes_int mask) {
  return _mm512_movepi64_mask((__m512i)mask);
}

INLINE lanes lanes_choose(lanes_int mask, lanes a, lanes b) {
  return (lanes)_mm512_mask_mov_pd((__m512d)b, _mm512_movepi64_mask((__m512i)mask), (__m512d)a);
}

INLINE lanes lanes_root(lanes x) {
  return (lanes)_mm512_sqrt_pd((__m512d)x);
}

/** Stores half a vector of floats past the cache. */
INLINE void store_past(float *to, narrow x) {
  _mm256_stream_ps(to, (__m256)x);
}

INLINE void end_past(void) {
  _mm_sfence();
}

#include "voxel/closest/band_tile_body.inc"

_Static_assert((int)NEXT_ROW == (int)VXM_BAND_ROW, "rows lie as far apart as they are loaded");

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
