/* SPDX-License-Identifier: BSD-3-Clause */
/** What follows in a file, up to base/build_end.h, is the build for processors with AVX2 (base/cpu.h). */
#define VXM_USE_AVX2 1
#define VXM_USE_AVX512 0
#define BUILD(name) name##_avx2
#define BUILD_LEVEL VXM_CPU_AVX2

#include <immintrin.h>
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2,popcnt,lzcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,fma,bmi,bmi2,popcnt,lzcnt")
#endif
