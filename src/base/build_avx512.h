/* SPDX-License-Identifier: BSD-3-Clause */
/** What follows in a file, up to base/build_end.h, is the build for processors with AVX-512 (base/cpu.h). */
#define VXM_USE_AVX2 1
#define VXM_USE_AVX512 1
#define BUILD(name) name##_avx512
#define BUILD_LEVEL VXM_CPU_AVX512

#include <immintrin.h>
#if defined(__clang__)
#pragma clang attribute push(                                                                          \
    __attribute__((target("avx512f,avx512cd,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt"))), \
    apply_to = function)
#else
#pragma GCC target("avx512f,avx512cd,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt")
#endif
