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

INLINE wide_mask wide_not_above(wide a, wide b) {
  return _mm256_cmp_ps((__m256)a, (__m256)b, _CMP_NGT_UQ);
}

/** On which side of a triangle's middle points lie: 1 = below. */
typedef __m256i wide_side;

INLINE wide_side side_of(wide x) {
  return _mm256_srli_epi32((__m256i)x, 31);
}

/** What is so on that side, out of two numbers that stand in every quarter of a vector: blending takes three
 * operations on some processors. */
INLINE wide pick_side(wide_side side, const float sides[2]) {
  double both;
  memcpy(&both, sides, sizeof both);
  return (wide)_mm256_permutevar_ps((__m256)_mm256_set1_pd(both), side);
}

INLINE unsigned wide_bits(wide_mask mask) {
  return (unsigned)_mm256_movemask_ps(mask);
}

/** For each eight bits the lanes that have one, in bytes. */
#define LANE(bits, n) \
  ((bits) >> (n)&1 ? (uint64_t)(n) << 8 * __builtin_popcount((bits) & ((1U << (n)) - 1)) : 0)
#define LANES_OF(bits)                                                                             \
  (LANE(bits, 0) | LANE(bits, 1) | LANE(bits, 2) | LANE(bits, 3) | LANE(bits, 4) | LANE(bits, 5) | \
   LANE(bits, 6) | LANE(bits, 7))
#define FOUR(bits) LANES_OF(bits), LANES_OF((bits) + 1), LANES_OF((bits) + 2), LANES_OF((bits) + 3)
#define SIXTEEN(bits) FOUR(bits), FOUR((bits) + 4), FOUR((bits) + 8), FOUR((bits) + 12)
#define MANY(bits) SIXTEEN(bits), SIXTEEN((bits) + 16), SIXTEEN((bits) + 32), SIXTEEN((bits) + 48)
static const uint64_t lanes_of_bits[256] = {MANY(0U), MANY(64U), MANY(128U), MANY(192U)};
#undef MANY
#undef SIXTEEN
#undef FOUR
#undef LANES_OF
#undef LANE

/** The numbers of the lanes that have a bit, one behind the other. */
INLINE __m256i lanes_chosen(unsigned bits) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)&lanes_of_bits[bits]));
}

/** Puts the voxels of a brick that have a bit behind `count` others. */
INLINE void gather(vxm_band_gathered *to, size_t count, const wide q[3], int32_t first, unsigned bits) {
  const __m256i lane = lanes_chosen(bits);
  for (int a = 0; a < 3; a++)
    _mm256_storeu_ps(to->at[a] + count, _mm256_permutevar8x32_ps((__m256)q[a], lane));
  _mm256_storeu_si256((__m256i *)(void *)(to->place + count),
                      _mm256_add_epi32(lane, _mm256_set1_epi32(first)));
}

/** Puts a triangle and the voxels of a group that have a bit behind `count` other pairs; returns how many
 * there are then. */
INLINE size_t add_pairs(vxm_band_pairs *to, size_t count, int32_t triangle, const int32_t *place,
                        unsigned bits) {
  const __m256i places = _mm256_loadu_si256((const __m256i *)(const void *)place);
  _mm256_storeu_si256((__m256i *)(void *)(to->place + count),
                      _mm256_permutevar8x32_epi32(places, lanes_chosen(bits)));
  _mm256_storeu_si256((__m256i *)(void *)(to->triangle + count), _mm256_set1_epi32(triangle));
  return count + (size_t)_mm_popcnt_u32(bits);
}

/** Keeps two numbers of triangles from one that is a multiple of LANES on: those of each side by side. */
INLINE void lanes_put(double *to, size_t triangle, lanes a, lanes b) {
  const __m256d even = _mm256_unpacklo_pd((__m256d)a, (__m256d)b),
                odd = _mm256_unpackhi_pd((__m256d)a, (__m256d)b);
  _mm256_store_pd(to + 2 * triangle, _mm256_permute2f128_pd(even, odd, 0x20));
  _mm256_store_pd(to + 2 * triangle + 4, _mm256_permute2f128_pd(even, odd, 0x31));
}

/** The two numbers of a triangle for each lane. */
INLINE void lanes_pick(lanes out[2], const double *from, const int32_t *which) {
  __m256d both[2];
  for (int n = 0; n < 2; n++)
    both[n] = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(from + 2 * (size_t)which[n])),
                                   _mm_load_pd(from + 2 * (size_t)which[n + 2]), 1);
  out[0] = (lanes)_mm256_unpacklo_pd(both[0], both[1]);
  out[1] = (lanes)_mm256_unpackhi_pd(both[0], both[1]);
}

/** By eight loads: one instruction for it is slower, where it follows stores to these places most of all. */
INLINE wide wide_gather(const float *from, const int32_t *place) {
  return (wide){from[place[0]], from[place[1]], from[place[2]], from[place[3]],
                from[place[4]], from[place[5]], from[place[6]], from[place[7]]};
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
INLINE void store_streaming(float *to, narrow x) {
  _mm_stream_ps(to, (__m128)x);
}

INLINE void end_streaming(void) {
  _mm_sfence();
}

#include "voxel/closest/band_tile_body.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
