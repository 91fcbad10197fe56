/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing for x86 processors with AVX2. */
#include "base/cpu.h"

#if VXM_KERNELS_X86
#include <immintrin.h>
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2,popcnt,lzcnt"))), apply_to = function)
#else
#pragma GCC target("avx2,fma,bmi,bmi2,popcnt,lzcnt")
#endif

#define LANES 4
#define BUILD(name) name##_avx2
#define BUILD_NAME "avx2"
#include "voxel/surface/surface_i64.inc"

#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
