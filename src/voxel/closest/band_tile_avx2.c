/* SPDX-License-Identifier: BSD-3-Clause */
/** Tiles of distances for x86 processors with AVX2. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include "voxel/closest/band_tile.h"

#include <immintrin.h>
#include <string.h>
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2,popcnt,lzcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,fma,bmi,bmi2,popcnt,lzcnt")
#endif

#define LANES 4
#define WIDTH 8
#define ACROSS 4
#define DOWN 2
#define DEEP 1
#define BUILD(name) name##_avx2

typedef float wide __attribute__((vector_size(4 * WIDTH)));
typedef float narrow __attribute__((vector_size(4 * LANES)));
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lanes_int __attribute__((vector_size(8 * LANES)));
typedef double lanes_loaded __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef __m256 wide_mask;

#define INLINE static inline __attribute__((always_inline))
#define UNROLL _Pragma("GCC unroll 8")

#include "voxel/closest/band_eight_avx.inc"

INLINE wide wide_max(wide a, wide b) {
  return (wide)_mm256_max_ps((__m256)a, (__m256)b);
}

INLINE wide wide_min(wide a, wide b) {
  return (wide)_mm256_min_ps((__m256)a, (__m256)b);
}

INLINE wide wide_size(wide x) {
  return (wide)_mm256_andnot_ps(_mm256_set1_ps(-0.0F), (__m256)x);
}

/** How far a number is beyond a half, which is not below 0: either way from 0. */
INLINE wide wide_beyond(wide x, wide half) {
  return wide_max(wide_size(x), half) - half;
}

INLINE wide wide_fma(wide a, wide b, wide c) {
  return (wide)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
}

INLINE wide_mask wide_less(wide a, wide b) {
  return _mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ);
}

INLINE wide_mask wide_not_above(wide a, wide b) {
  return _mm256_cmp_ps((__m256)a, (__m256)b, _CMP_NGT_UQ);
}

INLINE wide wide_choose(wide_mask mask, wide a, wide b) {
  return (wide)_mm256_blendv_ps((__m256)b, (__m256)a, mask);
}

INLINE unsigned wide_bits(wide_mask mask) {
  return (unsigned)_mm256_movemask_ps(mask);
}

/** Puts the voxels of a brick that have a bit behind `count` others: half of a vector at a time. */
INLINE void gather(vxm_band_gathered *to, size_t count, const wide q[3], int32_t first, unsigned bits) {
  static const _Alignas(16)
      int32_t chosen[16][4] = {{0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
                               {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
  const __m128i low = _mm_load_si128((const __m128i *)(const void *)chosen[bits & 15]),
                high = _mm_load_si128((const __m128i *)(const void *)chosen[bits >> 4]);
  const size_t second = count + (size_t)_mm_popcnt_u32(bits & 15);
  for (int a = 0; a < 3; a++) {
    _mm_storeu_ps(to->at[a] + count, _mm_permutevar_ps(_mm256_castps256_ps128((__m256)q[a]), low));
    _mm_storeu_ps(to->at[a] + second, _mm_permutevar_ps(_mm256_extractf128_ps((__m256)q[a], 1), high));
  }
  _mm_storeu_si128((__m128i *)(void *)(to->place + count), _mm_add_epi32(low, _mm_set1_epi32(first)));
  _mm_storeu_si128((__m128i *)(void *)(to->place + second), _mm_add_epi32(high, _mm_set1_epi32(first + 4)));
}

#include "voxel/closest/band_one_by_one.inc"

INLINE wide wide_gather(const float *from, const int32_t *place) {
  return (wide)_mm256_i32gather_ps(from, _mm256_loadu_si256((const __m256i *)(const void *)place), 4);
}

INLINE lanes lanes_max(lanes a, lanes b) {
  return (lanes)_mm256_max_pd((__m256d)a, (__m256d)b);
}

INLINE lanes lanes_min(lanes a, lanes b) {
  return (lanes)_mm256_min_pd((__m256d)a, (__m256d)b);
}

INLINE unsigned lanes_bits(lanes_int mask) {
  return (unsigned)_mm256_movemask_pd((__m256d)mask);
}

INLINE lanes lanes_choose(lanes_int mask, lanes a, lanes b) {
  return (lanes)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)mask);
}

INLINE lanes lanes_root(lanes x) {
  return (lanes)_mm256_sqrt_pd((__m256d)x);
}

/** Stores half a vector of floats past the cache. */
INLINE void store_past(float *to, narrow x) {
  _mm_stream_ps(to, (__m128)x);
}

INLINE void end_past(void) {
  _mm_sfence();
}

#include "voxel/closest/band_tile_body.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
