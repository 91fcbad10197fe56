/* SPDX-License-Identifier: BSD-3-Clause */
/** Nearest triangles for x86 processors with AVX2. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include <immintrin.h>
#include <stdint.h>
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,bmi2,popcnt,lzcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,bmi,bmi2,popcnt,lzcnt")
#endif

#define LANES 4
#define WIDTH 8
#define BUILD(name) name##_avx2

typedef float wide __attribute__((vector_size(4 * WIDTH)));
typedef int32_t wide_int __attribute__((vector_size(4 * WIDTH)));

static inline wide wide_max(wide a, wide b) {
  return (wide)_mm256_max_ps((__m256)a, (__m256)b);
}

static inline wide wide_min(wide a, wide b) {
  return (wide)_mm256_min_ps((__m256)a, (__m256)b);
}

static inline wide wide_choose(wide_int mask, wide a, wide b) {
  return (wide)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)mask);
}

static inline unsigned wide_mask(wide_int mask) {
  return (unsigned)_mm256_movemask_ps((__m256)mask);
}

typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lanes_int __attribute__((vector_size(8 * LANES)));

static inline lanes lanes_max(lanes a, lanes b) {
  return (lanes)_mm256_max_pd((__m256d)a, (__m256d)b);
}

static inline lanes lanes_min(lanes a, lanes b) {
  return (lanes)_mm256_min_pd((__m256d)a, (__m256d)b);
}

static inline lanes lanes_choose(lanes_int mask, lanes a, lanes b) {
  return (lanes)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)mask);
}

#include "voxel/closest/distance_bvh_body.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
