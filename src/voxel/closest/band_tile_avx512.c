/* SPDX-License-Identifier: BSD-3-Clause */
/** Tiles of distances for x86 processors with AVX-512. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include "voxel/closest/band_tile.h"

#include <immintrin.h>
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
#define UNROLL _Pragma("GCC unroll 8")

#include "voxel/closest/band_eight_avx.inc"

INLINE wide wide_max(wide a, wide b) {
  return (wide)_mm512_max_ps((__m512)a, (__m512)b);
}

INLINE wide wide_min(wide a, wide b) {
  return (wide)_mm512_min_ps((__m512)a, (__m512)b);
}

INLINE wide wide_size(wide x) {
  return (wide)_mm512_abs_ps((__m512)x);
}

/** How far a number is beyond a half, which is not below 0: either way from 0. */
INLINE wide wide_beyond(wide x, wide half) {
  return (wide)_mm512_range_ps((__m512)x, (__m512)half, 0xB) - half; /* the greater one by size */
}

INLINE wide wide_fma(wide a, wide b, wide c) {
  return (wide)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}

INLINE wide_mask wide_not_above(wide a, wide b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_NGT_UQ);
}

/** On which side of a triangle's middle points lie. */
typedef wide_mask wide_side;

INLINE wide_side side_of(wide x) {
  return _mm512_cmp_ps_mask((__m512)x, _mm512_setzero_ps(), _CMP_LT_OQ);
}

/** What is so on that side: the first of two is for those that are not below. */
INLINE wide pick_side(wide_side side, const float sides[2]) {
  return (wide)_mm512_mask_mov_ps(_mm512_set1_ps(sides[0]), side, _mm512_set1_ps(sides[1]));
}

INLINE unsigned wide_bits(wide_mask mask) {
  return mask;
}

/** Puts the voxels of a brick that have a bit behind `count` others. */
INLINE void gather(vxm_band_gathered *to, size_t count, const wide q[3], int32_t first, unsigned bits) {
  const __m512i number = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __mmask16 mask = (__mmask16)bits;
  for (int a = 0; a < 3; a++)
    _mm512_storeu_ps(to->at[a] + count, _mm512_maskz_compress_ps(mask, (__m512)q[a]));
  _mm512_storeu_si512(to->place + count,
                      _mm512_maskz_compress_epi32(mask, _mm512_add_epi32(number, _mm512_set1_epi32(first))));
}

INLINE wide wide_gather(const float *from, const int32_t *place) {
  return (wide)_mm512_i32gather_ps(_mm512_loadu_si512(place), from, 4);
}

#define HAS_WIDE_SCATTER
/** The first `count` of a vector. */
INLINE void wide_scatter(float *to, const int32_t *place, wide x, size_t count) {
  _mm512_mask_i32scatter_ps(to, (__mmask16)((1U << count) - 1), _mm512_loadu_si512(place), (__m512)x, 4);
}

/** Puts a triangle and the voxels of a group that have a bit behind `count` other pairs; returns how many
 * there are then. */
INLINE size_t add_pairs(vxm_band_pairs *to, size_t count, int32_t triangle, const int32_t *place,
                        unsigned bits) {
  const __m512i places = _mm512_loadu_si512(place);
  _mm512_storeu_si512(to->place + count, _mm512_maskz_compress_epi32((__mmask16)bits, places));
  _mm512_storeu_si512(to->triangle + count, _mm512_set1_epi32(triangle));
  return count + (size_t)_mm_popcnt_u32(bits);
}

/** Keeps two numbers of triangles from one that is a multiple of LANES on, out of sixteen. */
INLINE void lanes_put(double *to, size_t triangle, lanes a, lanes b) {
  _mm512_store_pd(to + triangle, (__m512d)a);
  _mm512_store_pd(to + 16 + triangle, (__m512d)b);
}

/** The two numbers of a triangle for each lane. */
INLINE void lanes_pick(lanes out[2], const double *from, const int32_t *which) {
  const __m512i index = _mm512_cvtepi32_epi64(_mm256_loadu_si256((const __m256i *)(const void *)which));
  for (int n = 0; n < 2; n++, from += 16)
    out[n] = (lanes)_mm512_permutex2var_pd(_mm512_load_pd(from), index, _mm512_load_pd(from + 8));
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
INLINE void store_streaming(float *to, narrow x) {
  _mm256_stream_ps(to, (__m256)x);
}

INLINE void end_streaming(void) {
  _mm_sfence();
}

#include "voxel/closest/band_tile_body.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
