/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing for x86 processors with AVX-512. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include <immintrin.h>
#if defined(__clang__)
#pragma clang attribute push(                                                                 \
    __attribute__((target("avx512f,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt"))), \
    apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,avx2,bmi,bmi2,popcnt,lzcnt")
#endif

#define LANES 8
#define BUILD(name) name##_avx512
#define BUILD_NAME "avx512"
#include "voxel/surface/surface_i64.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
